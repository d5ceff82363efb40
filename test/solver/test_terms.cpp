// Terms one by one through the battery, an own term among them, and the problem that they add up to.
#include <cmath>
#include <memory>

#include "snapwing/common/error.h"
#include "snapwing/elasticity/neo_hookean.h"
#include "snapwing/solver/elastic_term.h"
#include "snapwing/solver/inertia_term.h"
#include "snapwing/solver/load_term.h"
#include "snapwing/solver/newton.h"
#include "snapwing/solver/term_problem.h"
#include "support/block.h"
#include "support/term_check.h"

namespace snapwing::solver {
namespace {

using test::block;
using test::wavy;
constexpr double CELL = test::BLOCK_CELL, DENSITY = test::BLOCK_DENSITY;

template <int D>
test::TermCase caseOf(const mpm::Discretisation<D>& solid, int more) {
  test::TermCase c{HessianLayout(solid.dofCount() + more), {}};
  c.layout.addRegion(0, solid.pattern());
  for (const double phase : {0.0, 1.0}) c.y.push_back(wavy(solid.dofCount() + more, 5e-4, phase));
  return c;
}

TEST(ElasticTerm, IsATerm) {
  checkTerm(ElasticTerm<2>(block<2>()), caseOf<2>(*block<2>(), 0));
  checkTerm(ElasticTerm<2>(block<2>()), caseOf<2>(*block<2>(), 4));
  checkTerm(ElasticTerm<3>(block<3>()), caseOf<3>(*block<3>(), 9));
}

TEST(ElasticTerm, OfASecondRegionIsTheSame) {
  const auto solid = block<2>();
  const int dofs = solid->dofCount();
  test::TermCase c{HessianLayout(2 * dofs), {wavy(2 * dofs, 5e-4, 0)}};
  c.layout.addRegion(0, solid->pattern());
  c.layout.addRegion(dofs, solid->pattern());
  checkTerm(ElasticTerm<2>(solid, 1, dofs), c);
  Sum first, second;
  for (const int region : {0, 1}) {
    Eigen::VectorXd y = Eigen::VectorXd::Zero(2 * dofs);
    y.segment(region * dofs, dofs) = wavy(dofs, 5e-4, 0);
    Sum& sum = region == 0 ? first : second;
    sum.reset(c.layout, 1, Order::TANGENT);
    ElasticTerm<2>(solid, region, region * dofs).evaluate({y, c.p, nullptr, 1}, Order::TANGENT, sum);
  }
  EXPECT_EQ(first.energy, second.energy);
  EXPECT_EQ((first.gradient.head(dofs) - second.gradient.tail(dofs)).norm(), 0);
  const int half = c.layout.entries() / 2;
  for (int k = 0; k < half; ++k) ASSERT_EQ(first.hessian[k], second.hessian[half + k]);
}

TEST(LoadTerm, IsATerm) {
  test::TermCase c{HessianLayout(6), {wavy(6, 1e-3, 0)}};
  c.p = Eigen::Vector2d(0.3, -2);
  c.energy_depends_on_control = true;
  Eigen::MatrixXd per_control(5, 2);
  per_control << 1, 2, 3, 4, 5, 6, 7, 8, 9, 10;
  checkTerm(LoadTerm(wavy(5, 3, 1), per_control), c);
}

TEST(InertiaTerm, IsATerm) {
  const auto solid = block<3>();
  const auto mass = std::make_shared<const mpm::Mass<3>>(*solid, std::vector<double>{DENSITY});
  Step step;
  step.h = 1e-3, step.kappa = 2e6;
  step.y0 = wavy(solid->dofCount(), 1e-4, 2);
  step.v0 = wavy(solid->dofCount(), 0.2, 3);
  test::TermCase c = caseOf<3>(*solid, 0);
  c.step = &step;
  checkTerm(InertiaTerm<3>(mass), c);
  Sum still;
  still.reset(c.layout, 1, Order::TANGENT);
  InertiaTerm<3>(mass).evaluate({c.y[0], c.p, nullptr, 1}, Order::TANGENT, still);
  EXPECT_EQ(still.energy, 0) << "there is no inertia in statics";
}

/// Spring between two coordinates with play: V = k/2 max(|g| - band, 0)^2, g = row . y [m].
class DeadBandSpring : public Term {
 public:
  DeadBandSpring(std::vector<int> coordinates, Eigen::VectorXd row, double stiffness, double band)
      : coordinates_(std::move(coordinates)), row_(std::move(row)), k_(stiffness), band_(band) {}
  std::string name() const override { return "spring with a dead band"; }
  Role role() const override { return Role::STORED; }
  std::vector<std::vector<int>> couples() const override { return {coordinates_}; }
  void evaluate(const Point& at, Order order, Sum& sum) const override {
    double g = 0;
    for (std::size_t k = 0; k < coordinates_.size(); ++k) g += row_(static_cast<int>(k)) * at.y(coordinates_[k]);
    const double over = std::max(std::abs(g) - band_, 0.0), force = std::copysign(k_ * over, g);
    sum.energy += 0.5 * k_ * over * over;
    sum.stored += 0.5 * k_ * over * over;
    sum.noteForce(std::abs(force) * row_.norm());
    if (order == Order::ENERGY) return;
    for (std::size_t k = 0; k < coordinates_.size(); ++k) {
      sum.gradient(coordinates_[k]) += force * row_(static_cast<int>(k));
    }
    if (elasticity::withTangent(order) && over > 0) sum.addRankOne(0, k_, row_);
  }

 private:
  std::vector<int> coordinates_;
  Eigen::VectorXd row_;
  double k_, band_;
};

TEST(OwnTerm, IsATerm) {
  const DeadBandSpring spring({4, 1}, Eigen::Vector2d(1, -1), 300, 1e-3);
  test::TermCase c{HessianLayout(6), {}, Eigen::VectorXd::Zero(1), nullptr, 1e-4};
  for (const double stretch : {0.0, 4e-3, -4e-3}) c.y.push_back(stretch * Eigen::VectorXd::Unit(6, 4));
  checkTerm(spring, c);
}

TEST(TermProblem, OwnTermPullsOnASolid) {
  const auto solid = block<2>();
  const int dofs = solid->dofCount();
  std::vector<Equation> held;
  int corner = -1;
  for (int n = 0; n < solid->nodeCount(); ++n) {
    const mpm::Vector<2> x = solid->position(n);
    if (x(0) < 1e-9) {
      for (int axis = 0; axis < 2; ++axis) held.push_back({{{2 * n + axis, 1.0}}, {}, 0, "wall"});
    } else if (x(0) > 4 * CELL - 1e-9 && x(1) > 3 * CELL - 1e-9) {
      corner = 2 * n + 1;
    }
  }
  ASSERT_GE(corner, 0);
  auto coordinates = std::make_shared<const Coordinates>(Reduction(dofs, 0, held), 2);
  Eigen::VectorXd load = Eigen::VectorXd::Zero(dofs);
  load(corner) = 5;
  const auto tip = [&](const std::vector<std::shared_ptr<const Term>>& more) {
    TermProblem::Parts parts = solidParts<2>(solid, coordinates, 1, 1e-9);
    parts.terms.push_back(std::make_shared<const LoadTerm>(load, Eigen::MatrixXd()));
    parts.terms.insert(parts.terms.end(), more.begin(), more.end());
    const TermProblem problem(std::move(parts));
    Newton newton(problem, {});
    Eigen::VectorXd z = Eigen::VectorXd::Zero(problem.freeCount());
    Evaluation at;
    EXPECT_TRUE(newton.solve(Eigen::VectorXd(), z, at).converged());
    return at.place.y(corner);
  };
  const double alone = tip({});
  const auto spring = std::make_shared<const DeadBandSpring>(std::vector<int>{corner}, Eigen::VectorXd::Ones(1),
                                                             5 / alone, 0.25 * alone);
  // Spring and block are as stiff as each other, and the motion is small: u = a - (u - a / 4).
  EXPECT_NEAR(tip({spring}), 0.625 * alone, 1e-3 * alone);
  EXPECT_THROW(TermProblem([&] {
                 TermProblem::Parts parts = solidParts<2>(solid, coordinates, 1, 1e-9);
                 parts.terms.push_back(
                     std::make_shared<const DeadBandSpring>(std::vector<int>{dofs}, Eigen::VectorXd::Ones(1), 1, 1));
                 return parts;
               }()),
               common::Error);
}

/// One body that is nothing but a rotation and its centre: 9 entries of E and 3 of c, driven by own terms.
TEST(Coordinates, RenewalLeavesThePlaceAndTurnsOnFromThere) {
  const double length = 0.02;
  const Rotation free{3, length, {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()}};
  const Coordinates coordinates(Reduction(12, 0, {}), 3, {free});
  ASSERT_EQ(coordinates.freeCount(), 6);
  Eigen::VectorXd z(6);
  z << 1e-3, 2e-3, -1e-3, 0.9 * length, -0.4 * length, 1.3 * length;
  const Eigen::VectorXd before = coordinates.expand(z, Eigen::VectorXd());
  std::shared_ptr<const References> reference = coordinates.renew(z, nullptr);
  EXPECT_EQ(z.tail(3).norm(), 0);
  EXPECT_LT((coordinates.expand(z, Eigen::VectorXd(), reference.get()) - before).norm(), 1e-15);
  // Two hundred more turns of a radian each about one axis: still a rotation, and the right one.
  const Eigen::Matrix3d start = reference->rotation[0];
  for (int k = 0; k < 200; ++k) {
    z(5) = length;
    reference = coordinates.renew(z, reference.get());
  }
  const Eigen::Matrix3d r = reference->rotation[0];
  EXPECT_LT((r.transpose() * r - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  Eigen::Matrix3d turned;
  turned << std::cos(200.0), -std::sin(200.0), 0, std::sin(200.0), std::cos(200.0), 0, 0, 0, 1;
  EXPECT_LT((r - turned * start).norm(), 1e-12);
}

TEST(Coordinates, PullBackIsTheTransposeOfPush) {
  const double length = 0.02;
  const Rotation free{3, length, {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()}};
  const Rotation hinge{12, length, {Eigen::Vector3d(0, 0.6, 0.8)}};
  const Coordinates coordinates(Reduction(21, 0, {}), 3, {free, hinge});
  Eigen::VectorXd z = wavy(coordinates.freeCount(), 1.1 * length, 0.4), start = z;
  const std::shared_ptr<const References> reference = coordinates.renew(start, nullptr);
  Coordinates::Place at, from;
  coordinates.at(z, Eigen::VectorXd(), reference.get(), at);
  coordinates.at(start, Eigen::VectorXd(), reference.get(), from);
  const Eigen::VectorXd f = wavy(21, 1, 0.1), dz = wavy(coordinates.freeCount(), 1, 2.2);
  EXPECT_NEAR(coordinates.pullBack(at, f).dot(dz), f.dot(coordinates.push(at, dz, Eigen::VectorXd())), 1e-13);
  EXPECT_TRUE(test::derivativeMatches(
      [&](double h) { return coordinates.expand(z + h * dz, Eigen::VectorXd(), reference.get()); },
      coordinates.push(at, dz, Eigen::VectorXd()), length, 1e-8));
  // A step from rest to rest is tested along its own mean: the same as the slope.
  EXPECT_LT((coordinates.pullBackMean(from, from, f) - coordinates.pullBack(from, f)).norm(), 1e-14);
  // The way from one place to the other is among the directions that the mean tests: d . f is the work of f.
  const Eigen::VectorXd d = at.y - from.y;
  const Eigen::VectorXd tested = coordinates.pullBackMean(from, at, f);
  double work = 0;
  for (int k = 0; k < 3; ++k) work += tested(k) * d(k);
  // Rotation vector a with R1 - R0 = [a] (R0 + R1) / 2 of each rotation, a = 2 tan(t / 2) n.
  const auto tangent = [&](const Eigen::VectorXd& angles) {
    const double t = angles.norm() / length;
    return Eigen::VectorXd(angles.normalized() * (2 * std::tan(0.5 * t) * length));
  };
  const int own = coordinates.freeCount();
  work += tested.segment(own - 4, 3).dot(tangent(z.segment(own - 4, 3)));
  work += tested(own - 1) * tangent(z.tail(1))(0);
  EXPECT_NEAR(work, d.dot(f), 1e-12);
}

}  // namespace
}  // namespace snapwing::solver
