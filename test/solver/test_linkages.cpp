// Rigid bodies in pins and closed chains: the term and its derivatives, what is redundant, and motion against ordinary
// differential equations in the angles.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <functional>

#include "linkage.h"
#include "snapwing/common/error.h"
#include "support/term_check.h"

namespace snapwing::solver {
namespace {

using testing_linkages::Bar;
using testing_linkages::GRAVITY;
using testing_linkages::Linkage;
using testing_linkages::makeLinkage;
using testing_linkages::Pin;

const std::vector<Bar> PENDULUM = {{{0, 0}, {0.1, 0}, 0.12}, {{0.1, 0}, {0.1, -0.14}, 0.2}};
const std::vector<Pin> HUNG = {{"shoulder", 0, -1, {0, 0}}, {"elbow", 1, 0, {0.1, 0}}};

/// Crank 30, coupler 80, rocker 60 mm on ground pivots 70 mm apart: the crank goes round.
struct FourBar {
  double crank = 0.03, coupler = 0.08, rocker = 0.06, ground = 0.07;
  /// Angles of coupler and rocker against x at one of the crank.
  Eigen::Vector2d others(double theta) const {
    const Eigen::Vector2d a(crank * std::cos(theta), crank * std::sin(theta)), b(ground, 0), d = b - a;
    const double r = d.norm();
    const double alpha = std::acos((coupler * coupler + r * r - rocker * rocker) / (2 * coupler * r));
    const double phi = std::atan2(d(1), d(0)) + alpha;
    const Eigen::Vector2d c = a + coupler * Eigen::Vector2d(std::cos(phi), std::sin(phi));
    return {phi, std::atan2(c(1), c(0) - ground)};
  }
  std::vector<Bar> bars(double theta) const {
    const Eigen::Vector2d o = others(theta);
    const Eigen::Vector2d a(crank * std::cos(theta), crank * std::sin(theta)), g(ground, 0);
    const Eigen::Vector2d c = g + rocker * Eigen::Vector2d(std::cos(o(1)), std::sin(o(1)));
    return {{Eigen::Vector2d::Zero(), a, 0.05}, {a, c, 0.09}, {g, c, 0.07}};
  }
  std::vector<Pin> pins(double theta) const {
    const std::vector<Bar> b = bars(theta);
    return {{"ground left", 0, -1, b[0].from},
            {"crank pin", 0, 1, b[0].to},
            {"rocker pin", 1, 2, b[1].to},
            {"ground right", 2, -1, b[2].from}};
  }
};

/// Residual, Hessian and rows of a problem with constraints against differences, at multipliers that are not zero.
void checkLagrangian(const Problem& problem, const Eigen::VectorXd& z, double scale) {
  const int count = problem.constraints()->count();
  Eigen::VectorXd lambda(count), d(z.size());
  for (int k = 0; k < count; ++k) lambda(k) = 0.7 * std::cos(1.3 * k);
  for (int k = 0; k < z.size(); ++k) d(k) = std::sin(2.1 * k + 1);
  const Eigen::VectorXd p = Eigen::VectorXd::Zero(problem.controlCount());
  Evaluation at, other;
  problem.evaluateLagrangian(z, p, lambda, Order::TANGENT, at);
  const auto energy = [&](double h) {
    problem.evaluateLagrangian(z + h * d, p, lambda, Order::ENERGY, other);
    return Eigen::VectorXd::Constant(1, other.energy);
  };
  const auto residual = [&](double h) {
    problem.evaluateLagrangian(z + h * d, p, lambda, Order::STRESS, other);
    return other.residual;
  };
  const auto gap = [&](double h) {
    problem.evaluateLagrangian(z + h * d, p, lambda, Order::ENERGY, other);
    return other.constraint_residual;
  };
  EXPECT_GT(at.constraint_residual.norm(), 1e-4) << "away from where they hold";
  EXPECT_TRUE(test::derivativeMatches(energy, Eigen::VectorXd::Constant(1, at.residual.dot(d)), scale, 1e-8));
  EXPECT_TRUE(test::derivativeMatches(residual, problem.pattern().multiply(at.hessian, d), scale, 1e-8));
  EXPECT_TRUE(test::derivativeMatches(gap, *at.rows * d, scale, 1e-8));
}

TEST(Linkage, LagrangianHasItsDerivativesAwayFromItsConstraints) {
  const FourBar four;
  for (const bool keep : {false, true}) {
    const Linkage linkage = makeLinkage(four.bars(0.8), four.pins(0.8), keep);
    ASSERT_NE(linkage.problem->constraints(), nullptr);
    Eigen::VectorXd alone = Eigen::VectorXd::Zero(linkage.problem->freeCount());
    Evaluation never;
    EXPECT_THROW(Newton(*linkage.problem, {}).solve(Eigen::VectorXd(), alone, never), common::Error);
    EXPECT_EQ(linkage.problem->constraints()->count(), keep ? 8 : 2);
    EXPECT_EQ(linkage.redundant, 0);
    Eigen::VectorXd z(linkage.problem->freeCount());
    for (int k = 0; k < z.size(); ++k) z(k) = 0.02 * std::sin(1.7 * k + 0.2);
    checkLagrangian(*linkage.problem, z, 0.01);
  }
}

TEST(ConstraintTerm, IsATerm) {
  LinearRows rows;
  rows.rows.resize(2, 6);
  rows.rows.insert(0, 1) = 2;
  rows.rows.insert(0, 4) = -1;
  rows.rows.insert(1, 0) = 0.5;
  rows.control = Eigen::MatrixXd::Constant(2, 2, 0.3);
  rows.control(1, 0) = -2;
  rows.constant = Eigen::Vector2d(1e-3, 0);
  rows.names = {"a", "b"};
  rows.equation = {0, 1};
  test::TermCase c{HessianLayout(6), {Eigen::VectorXd::LinSpaced(6, -1e-3, 2e-3)}};
  c.p = Eigen::Vector2d(0.3, -2);
  c.energy_depends_on_control = true;
  checkTerm(ConstraintTerm(std::make_shared<const Constraints>(rows, Enforcement::MULTIPLIERS, 300, 1e-12)), c);
  EXPECT_THROW(Constraints(rows, Enforcement::AUGMENTED_LAGRANGIAN, 0, 1e-12), common::Error);
  EXPECT_THROW(Constraints(rows, Enforcement::ELIMINATION, 1, 1e-12), common::Error);
  EXPECT_THROW(Constraints(rows, Enforcement::MULTIPLIERS, 1, 0), common::Error);
  rows.names.pop_back();
  EXPECT_THROW(Constraints(rows, Enforcement::MULTIPLIERS, 1, 1e-12), common::Error);
}

/// Two bars in two pins are one body: of the equations that turn them alike one follows from the other.
TEST(Linkage, RedundantPinsAreCounted) {
  const std::vector<Bar> bars = {{{0, 0}, {0.1, 0}}, {{0, 0}, {0.1, 0}}};
  const std::vector<Pin> pins = {{"left", 0, 1, {0, 0}}, {"right", 0, 1, {0.1, 0}}, {"wall", 0, -1, {0, 0}}};
  EXPECT_EQ(makeLinkage(bars, pins, false).redundant, 1);
  EXPECT_EQ(makeLinkage(bars, pins, true).redundant, 1);
}

/// Of a triangle of pinned bars nothing moves, and pins of another length apart cannot hold at all.
TEST(Linkage, WhatCannotHoldTogetherIsRefusedByName) {
  const FourBar four;
  std::vector<Pin> pins = four.pins(0.8);
  pins.push_back({"nail", 1, -1, four.bars(0.8)[1].centre()});
  EXPECT_EQ(makeLinkage(four.bars(0.8), pins, false).redundant, 1) << "it holds what could move, and once more";
  LinearRows apart;
  apart.rows.resize(2, 12);
  apart.rows.insert(0, 4) = apart.rows.insert(1, 5) = 1;
  apart.control = Eigen::MatrixXd::Zero(2, 0);
  apart.constant = Eigen::Vector2d(0.03, 0.03);  // E of one angle cannot be so
  apart.names = {"first", "second"};
  apart.equation = {0, 1};
  const Linkage free = makeLinkage({PENDULUM[0], PENDULUM[1]}, {}, false);
  try {
    redundantRows(free.problem->coordinates(), apart, 1e-4);
    FAIL() << "accepted";
  } catch (const common::Error& e) {
    EXPECT_NE(std::string(e.what()).find("'first'"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("cannot hold together"), std::string::npos) << e.what();
  }
}

/// Steps of the midpoint family with the mean pull-back, through the solver of equilibria.
class Stepper {
 public:
  Stepper(const Linkage& linkage, double h) : linkage_(linkage), h_(h), context_(std::make_shared<StepContext>()) {
    x_.z = Eigen::VectorXd::Zero(linkage.problem->freeCount());
    const Constraints* constraints = linkage.problem->constraints();
    x_.multipliers = Eigen::VectorXd::Zero(constraints != nullptr ? constraints->count() : 0);
    y = linkage.problem->coordinates().expand(x_.z, Eigen::VectorXd());
    v = Eigen::VectorXd::Zero(y.size());
    step_ = std::make_unique<StepProblem>(linkage.problem, context_, nullptr);
    NewtonSettings settings;
    settings.relative_tolerance = 1e-12;
    solver_ = std::make_unique<EquilibriumSolver>(*step_, settings, ControlLine{Eigen::VectorXd(), Eigen::VectorXd()});
  }
  Eigen::VectorXd y, v;
  int iterations = 0;

  void run(int steps) {
    for (int k = 0; k < steps && !::testing::Test::HasFatalFailure(); ++k) step();
  }

 private:
  void step() {
    const Coordinates& coordinates = linkage_.problem->coordinates();
    context_ = std::make_shared<StepContext>();
    context_->step = {h_, 2 / (h_ * h_), y, v, Eigen::VectorXd(), {{0.5, 1.0}}};
    auto start = std::make_shared<Coordinates::Place>();
    coordinates.at(x_.z, Eigen::VectorXd(), references_.get(), *start);
    context_->mean_with = start;
    step_->setStep(context_, references_);
    const NewtonResult result = solver_->minimise(x_);
    ASSERT_TRUE(result.converged()) << result.message;
    iterations += result.iterations;
    v = 2 * (x_.at.place.y - y) / h_ - v;
    y = x_.at.place.y;
    references_ = coordinates.renew(x_.z, references_.get());
  }

  const Linkage& linkage_;
  double h_;
  std::shared_ptr<StepContext> context_;
  std::unique_ptr<StepProblem> step_;
  std::unique_ptr<EquilibriumSolver> solver_;
  std::shared_ptr<const References> references_;
  Equilibrium x_;
};

/// Runge and Kutta's fourth order. @return state after `seconds`
Eigen::VectorXd integrate(const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& rate, Eigen::VectorXd x,
                          double seconds, int steps) {
  const double h = seconds / steps;
  for (int k = 0; k < steps; ++k) {
    const Eigen::VectorXd a = rate(x), b = rate(x + h / 2 * a), c = rate(x + h / 2 * b), d = rate(x + h * c);
    x += h / 6 * (a + 2 * b + 2 * c + d);
  }
  return x;
}

/// Angles of both bars against x and their rates: Lagrange's equations of two compound pendulums.
Eigen::VectorXd pendulumRate(const Eigen::VectorXd& x) {
  const double l = 0.1, half = 0.05, arm = 0.07;  // of the first bar, to its centre, to the second's
  const double m1 = PENDULUM[0].mass, m2 = PENDULUM[1].mass, difference = x(0) - x(1);
  Eigen::Matrix2d mass;
  mass(0, 0) = PENDULUM[0].inertia() + m1 * half * half + m2 * l * l;
  mass(1, 1) = PENDULUM[1].inertia() + m2 * arm * arm;
  mass(0, 1) = mass(1, 0) = m2 * l * arm * std::cos(difference);
  const Eigen::Vector2d load(
      -m2 * l * arm * std::sin(difference) * x(3) * x(3) - GRAVITY * (m1 * half + m2 * l) * std::cos(x(0)),
      m2 * l * arm * std::sin(difference) * x(2) * x(2) - GRAVITY * m2 * arm * std::cos(x(1)));
  Eigen::VectorXd rate(4);
  rate << x(2), x(3), mass.inverse() * load;
  return rate;
}

double apart(double a, double b) { return std::abs(std::remainder(a - b, 2 * std::acos(-1.0))); }

TEST(Motion, DoublePendulumFollowsItsEquations) {
  constexpr double SECONDS = 0.6, DOWN = -1.5707963267948966;
  Eigen::VectorXd start(4);
  start << 0, DOWN, 0, 0;
  const Eigen::VectorXd end = integrate(pendulumRate, start, SECONDS, 20000);
  EXPECT_GT(std::abs(end(0)), 0.3);
  for (const bool keep : {false, true}) {
    const Linkage linkage = makeLinkage(PENDULUM, HUNG, keep);
    EXPECT_EQ(linkage.problem->constraints() != nullptr, keep);
    double error[3], angle[3];
    for (const int k : {0, 1, 2}) {
      Stepper stepper(linkage, SECONDS / (300 << k));
      stepper.run(300 << k);
      angle[k] = linkage.angle(stepper.y, 1);
      error[k] = std::max(apart(linkage.angle(stepper.y, 0), end(0)), apart(angle[k] + DOWN, end(1)));
      const double energy = linkage.kinetic(stepper.v) + linkage.weights->energy(stepper.y);
      // What rounding of inertia leaves of forces, kappa M y times 1e-16, works over a step's way.
      EXPECT_NEAR(energy, linkage.weights->energy(0 * stepper.y), 1e-9 * linkage.kinetic(stepper.v));
    }
    EXPECT_NEAR(std::log2(error[1] / error[2]), 2, 0.1);
    EXPECT_LT(apart((4 * angle[2] - angle[1]) / 3 + DOWN, end(1)), 2e-3 * error[2]) << "extrapolated";
  }
}

TEST(Motion, KeptPinsMoveAsEliminatedOnes) {
  Eigen::VectorXd end[2];
  for (const bool keep : {false, true}) {
    const Linkage linkage = makeLinkage(PENDULUM, HUNG, keep);
    Stepper stepper(linkage, 2e-3);
    stepper.run(100);
    end[keep ? 1 : 0] = stepper.y;
  }
  EXPECT_LT((end[0] - end[1]).norm(), 1e-9 * end[0].norm());
}

/// The crank's angle alone: M q'' + M' q'^2 / 2 + V' = 0, with M and V of the geometry.
TEST(Motion, ClosedFourBarGoesRoundAsItsEquationSays) {
  constexpr double SECONDS = 0.5, START = 0.8, SPIN = 20;
  const FourBar four;
  const std::vector<Bar> bars = four.bars(START);
  const auto centres = [&](double theta) {
    const std::vector<Bar> now = four.bars(theta);
    Eigen::VectorXd place(9);
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < 2; ++i) place(2 * k + i) = 0.5 * (now[k].from(i) + now[k].to(i));
      const Eigen::Vector2d along = now[k].to - now[k].from;
      place(6 + k) = std::atan2(along(1), along(0));
    }
    return place;
  };
  const auto rates = [&](double theta) {  // by the crank's angle, to 1e-11
    constexpr double H = 1e-3;
    const auto slope = [&](double h) {
      Eigen::VectorXd d = centres(theta + h) - centres(theta - h);
      for (int k = 6; k < 9; ++k) d(k) = std::remainder(d(k), 2 * std::acos(-1.0));
      return Eigen::VectorXd(d / (2 * h));
    };
    return Eigen::VectorXd((4 * slope(H) - slope(2 * H)) / 3);
  };
  const auto mass = [&](double theta) {
    const Eigen::VectorXd r = rates(theta);
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      sum += bars[k].mass * r.segment(2 * k, 2).squaredNorm() + bars[k].inertia() * r(6 + k) * r(6 + k);
    }
    return sum;
  };
  const auto rate = [&](const Eigen::VectorXd& x) {
    constexpr double H = 2e-3;
    const double by_angle =
        (8 * (mass(x(0) + H) - mass(x(0) - H)) - mass(x(0) + 2 * H) + mass(x(0) - 2 * H)) / (12 * H);
    double pull = 0;
    const Eigen::VectorXd r = rates(x(0));
    for (int k = 0; k < 3; ++k) pull += bars[k].mass * GRAVITY * r(2 * k + 1);
    Eigen::VectorXd result(2);
    result << x(1), -(0.5 * by_angle * x(1) * x(1) + pull) / mass(x(0));
    return result;
  };
  const Eigen::VectorXd end = integrate(rate, Eigen::Vector2d(START, SPIN), SECONDS, 2000);
  EXPECT_GT(end(0) - START, 2 * std::acos(-1.0)) << "more than a turn";
  for (const bool keep : {false, true}) {
    const Linkage linkage = makeLinkage(bars, four.pins(START), keep);
    double error[2], angle[2];
    for (const int k : {0, 1}) {
      Stepper stepper(linkage, SECONDS / (500 << k));
      const Eigen::VectorXd r = SPIN * rates(START);
      for (int bar = 0; bar < 3; ++bar) {  // of c, the displacement of the origin, and of E
        const Eigen::Vector2d centre = bars[bar].centre();
        stepper.v.segment(2 * bar, 2) = r.segment(2 * bar, 2) - r(6 + bar) * Eigen::Vector2d(-centre(1), centre(0));
        stepper.v.segment(6 + 4 * bar, 4) = testing_linkages::LENGTH * r(6 + bar) * Eigen::Vector4d(0, 1, -1, 0);
      }
      const double kinetic = linkage.kinetic(stepper.v);
      EXPECT_NEAR(kinetic, 0.5 * mass(START) * SPIN * SPIN, 1e-9 * kinetic);
      stepper.run(500 << k);
      angle[k] = linkage.angle(stepper.y, 0);
      error[k] = apart(angle[k] + START, end(0));
      EXPECT_NEAR(linkage.kinetic(stepper.v) + linkage.weights->energy(stepper.y), kinetic, 1e-8 * kinetic);
      EXPECT_LT(stepper.iterations, 8 * (500 << k));
    }
    EXPECT_NEAR(std::log2(error[0] / error[1]), 2, 0.1);
    EXPECT_LT(apart((4 * angle[1] - angle[0]) / 3 + START, end(0)), 1e-2 * error[1]) << "extrapolated";
  }
}

/// A path of two controls on a line, and a problem without any.
TEST(ControlLine, LeadsSeveralControlsTogether) {
  LinearRows rows;
  rows.rows.resize(2, 2);
  rows.rows.insert(0, 0) = rows.rows.insert(1, 1) = 1;
  rows.control = Eigen::MatrixXd::Identity(2, 2);
  rows.constant = Eigen::VectorXd::Zero(2);
  rows.names = {"x", "y"};
  rows.equation = {0, 1};
  /// k/2 (y0 + 2 y1)^2
  class Spring : public Term {
   public:
    std::string name() const override { return "spring"; }
    Role role() const override { return Role::STORED; }
    std::vector<std::vector<int>> couples() const override { return {{0, 1}}; }
    void evaluate(const Point& at, Order order, Sum& sum) const override {
      const Eigen::Vector2d row(1, 2);
      const double stretch = row.dot(at.y);
      sum.energy += 50 * stretch * stretch;
      sum.stored += 50 * stretch * stretch;
      if (order == Order::ENERGY) return;
      sum.gradient += 100 * stretch * row;
      sum.noteForce(100 * std::abs(stretch));
      if (elasticity::withTangent(order)) sum.addRankOne(0, 100, row);
    }
  };
  TermProblem::Parts parts{HessianLayout(2),
                           std::make_shared<const Coordinates>(Reduction(2, 2, {}), 2),
                           {std::make_shared<const Spring>()},
                           1,
                           1e-12,
                           0};
  parts.constraints = std::make_shared<const Constraints>(rows, Enforcement::MULTIPLIERS, 1000, 1e-12);
  const TermProblem problem(std::move(parts));
  EXPECT_THROW(EquilibriumSolver(problem, {}), common::Error);
  EquilibriumSolver solver(problem, {}, {Eigen::Vector2d(0.1, 0), Eigen::Vector2d(3, -1)});
  Equilibrium x = solver.start(Eigen::VectorXd::Zero(2), 0.2);
  ASSERT_TRUE(solver.minimise(x).converged());
  solver.linearise(x);
  // At (0.7, -0.2) stretched by 0.3, which grows by 1 per t.
  EXPECT_NEAR(x.z(0), 0.7, 1e-12);
  EXPECT_NEAR(x.force(), 100 * 0.3 * 1, 1e-9);
  EXPECT_NEAR(x.stiffness, 100, 1e-8);
  EXPECT_EQ(x.negative_pivots, 0);
}

}  // namespace
}  // namespace snapwing::solver
