// A step in time as a problem: rigid bodies that spin keep energy and both momenta; the order of the rule.
#include <Eigen/Dense>
#include <cmath>
#include <memory>

#include "snapwing/common/error.h"
#include "snapwing/solver/newton.h"
#include "snapwing/solver/rigid_inertia_term.h"
#include "snapwing/solver/term_problem.h"
#include "support/term_check.h"

namespace snapwing::solver {
namespace {

constexpr double LENGTH = 0.05;  // [m]
const RigidMass ASYMMETRIC = RigidMass::of(0.2, {0.01, -0.02, 0.005}, Eigen::Vector3d(3e-4, 5e-4, 6e-4).asDiagonal());

Rotation freeRotation(int first) {
  return {first, LENGTH, {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()}};
}

/// Rate of (c, E) of a body that moves with a speed and turns with an angular velocity, at orientation R.
Eigen::VectorXd rigidRate(const Eigen::Vector3d& speed, const Eigen::Vector3d& spin, const Eigen::Matrix3d& r) {
  Eigen::VectorXd v(12);
  v.head(3) = speed;
  const Eigen::Matrix3d e = LENGTH * skewOf(spin) * r;
  for (int j = 0; j < 3; ++j) v.segment(3 + 3 * j, 3) = e.col(j);
  return v;
}

/// Steps of the midpoint family, with one renewal a step; dense, and plain Newton.
class Stepper {
 public:
  enum class Test { MEAN, END };
  Stepper(const std::shared_ptr<const TermProblem>& problem, double h, Test test)
      : problem_(problem), h_(h), test_(test) {
    z_ = Eigen::VectorXd::Zero(problem->freeCount());
    y = problem->coordinates().expand(z_, Eigen::VectorXd());
    v = Eigen::VectorXd::Zero(y.size());
  }
  Eigen::VectorXd y, v;
  int renew_every = 1;

  void run(int steps) {
    for (int k = 0; k < steps; ++k) step();
  }

 private:
  void step() {
    auto context = std::make_shared<StepContext>();
    context->step = {h_, 2 / (h_ * h_), y, v, Eigen::VectorXd(), {{0.5, 1.0}}};
    const Coordinates& coordinates = problem_->coordinates();
    auto start = std::make_shared<Coordinates::Place>();
    coordinates.at(z_, Eigen::VectorXd(), references_.get(), *start);
    if (test_ == Test::MEAN) context->mean_with = start;
    const StepProblem now(problem_, context, references_);
    Evaluation at;
    for (int iteration = 0; iteration < 40; ++iteration) {
      now.evaluate(z_, Eigen::VectorXd(), Order::TANGENT, at);
      ASSERT_TRUE(at.finite);
      if (at.residual.norm() < 1e-13 * at.force_scale) break;
      Eigen::MatrixXd h = Eigen::MatrixXd::Zero(z_.size(), z_.size());
      const SparsePattern& pattern = now.pattern();
      for (int c = 0; c < pattern.size; ++c) {
        for (int k = pattern.start[c]; k < pattern.start[c + 1]; ++k) {
          h(pattern.row[k], c) = h(c, pattern.row[k]) = at.hessian[k];
        }
      }
      z_ -= h.ldlt().solve(at.residual);
    }
    EXPECT_LT(at.residual.norm(), 1e-11 * at.force_scale);
    v = 2 * (at.place.y - y) / h_ - v;
    y = at.place.y;
    if (++count_ % renew_every == 0) references_ = coordinates.renew(z_, references_.get());
  }

  std::shared_ptr<const TermProblem> problem_;
  double h_;
  Test test_;
  Eigen::VectorXd z_;
  std::shared_ptr<const References> references_;
  int count_ = 0;
};

struct Body {
  std::shared_ptr<const RigidInertiaTerm> inertia;
  std::shared_ptr<const TermProblem> problem;
};

Body freeBody() {
  Body body;
  const Rotation rotation = freeRotation(3);
  body.inertia = std::make_shared<const RigidInertiaTerm>("body", 3, 0, rotation, ASYMMETRIC);
  auto coordinates = std::make_shared<const Coordinates>(Reduction(12, 0, {}), 3, std::vector<Rotation>{rotation});
  body.problem =
      std::make_shared<const TermProblem>(TermProblem::Parts{HessianLayout(12), coordinates, {body.inertia}, 1, 0, 0});
  return body;
}

TEST(RigidInertia, IsATerm) {
  const RigidInertiaTerm term("body", 3, 0, freeRotation(3), ASYMMETRIC);
  Step step;
  step.h = 1e-3, step.kappa = 2e6;
  step.y0 = Eigen::VectorXd::LinSpaced(12, -1e-3, 2e-3);
  step.v0 = Eigen::VectorXd::LinSpaced(12, 1, -2);
  test::TermCase c{HessianLayout(12), {Eigen::VectorXd::LinSpaced(12, 1e-3, -3e-3)}};
  c.step = &step;
  checkTerm(term, c);
}

TEST(RigidInertia, MomentaAndEnergyOfASpinningBodyAreInClosedForm) {
  const RigidInertiaTerm term("body", 3, 0, freeRotation(3), ASYMMETRIC);
  const Eigen::Vector3d speed(0.3, -0.1, 0.2), spin(2, 5, -3), centre(0.01, -0.02, 0.005);
  const Eigen::Matrix3d inertia = Eigen::Vector3d(3e-4, 5e-4, 6e-4).asDiagonal();
  const Eigen::VectorXd v = rigidRate(speed, spin, Eigen::Matrix3d::Identity());
  const Eigen::Vector3d of_centre = speed + spin.cross(centre);
  EXPECT_LT((term.momentum(v) - 0.2 * of_centre).norm(), 1e-15);
  const Eigen::Vector3d turning = inertia * spin + 0.2 * centre.cross(of_centre);
  EXPECT_LT((term.angularMomentum(Eigen::VectorXd::Zero(12), v) - turning).norm(), 1e-15);
  EXPECT_NEAR(term.kineticEnergy(v), 0.1 * of_centre.squaredNorm() + 0.5 * spin.dot(inertia * spin), 1e-15);
  EXPECT_THROW(RigidMass::of(1, Eigen::Vector3d::Zero(), Eigen::Vector3d(1, 1, 2.1).asDiagonal()), common::Error);
  EXPECT_THROW(RigidMass::of(0, Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity()), common::Error);
}

/// Torque-free, near its middle axis: it tumbles, and no step may lose anything.
TEST(Step, ATumblingBodyKeepsEnergyAndMomenta) {
  const Body body = freeBody();
  Stepper stepper(body.problem, 2e-3, Stepper::Test::MEAN);
  stepper.v = rigidRate({0.3, -0.1, 0.2}, {0.4, 40, -0.3}, Eigen::Matrix3d::Identity());
  const double energy = body.inertia->kineticEnergy(stepper.v);
  const Eigen::Vector3d linear = body.inertia->momentum(stepper.v);
  const Eigen::Vector3d angular = body.inertia->angularMomentum(stepper.y, stepper.v);
  stepper.run(2000);  // 25 turns
  EXPECT_NEAR(body.inertia->kineticEnergy(stepper.v), energy, 1e-10 * energy);
  EXPECT_LT((body.inertia->momentum(stepper.v) - linear).norm(), 1e-10 * linear.norm());
  EXPECT_LT((body.inertia->angularMomentum(stepper.y, stepper.v) - angular).norm(), 1e-10 * angular.norm());
}

TEST(Step, RenewalsEachStepOrEachTenthAreTheSame) {
  Eigen::VectorXd end[2];
  for (const int every : {1, 10}) {
    const Body body = freeBody();
    Stepper stepper(body.problem, 2e-3, Stepper::Test::MEAN);
    stepper.renew_every = every;
    stepper.v = rigidRate({0, 0, 0}, {3, 8, -5}, Eigen::Matrix3d::Identity());
    stepper.run(100);
    end[every / 10] = stepper.y;
  }
  EXPECT_GT(end[0].norm(), 0.01);
  EXPECT_LT((end[0] - end[1]).norm(), 1e-11 * end[0].norm());
}

/// Newton's method takes steps that lower the residual, where there is no potential.
TEST(Step, NewtonsMethodSolvesOne) {
  const Body body = freeBody();
  auto context = std::make_shared<StepContext>();
  const Eigen::VectorXd y = Eigen::VectorXd::Zero(12),
                        v = rigidRate({0.3, -0.1, 0.2}, {4, 40, -3}, Eigen::Matrix3d::Identity());
  constexpr double H = 5e-3;
  context->step = {H, 2 / (H * H), y, v, Eigen::VectorXd(), {{0.5, 1.0}}};
  auto start = std::make_shared<Coordinates::Place>();
  Eigen::VectorXd z = Eigen::VectorXd::Zero(6);
  body.problem->coordinates().at(z, Eigen::VectorXd(), nullptr, *start);
  context->mean_with = start;
  const StepProblem step(body.problem, context, nullptr);
  NewtonSettings settings;
  settings.relative_tolerance = 1e-13;
  Newton newton(step, settings);
  Evaluation at;
  const NewtonResult result = newton.solve(Eigen::VectorXd(), z, at);
  ASSERT_TRUE(result.converged()) << result.message;
  EXPECT_FALSE(at.potential);
  const double energy = body.inertia->kineticEnergy(v);
  EXPECT_NEAR(body.inertia->kineticEnergy(2 * (at.place.y - y) / H - v), energy, 1e-11 * energy);
}

/// Pendulum in the plane, hung at its reference: order 2 of the angle with the mean, 1 with the end's own directions.
TEST(Step, OrderOfAPendulum) {
  const double mass = 0.3, arm = 0.08, gravity = 9.81, seconds = 0.5;
  const Rotation rotation{2, LENGTH, {Eigen::Vector3d::UnitZ()}};
  const RigidMass bob = RigidMass::of(mass, {arm, 0, 0}, Eigen::Vector3d(1e-4, 1e-4, 2e-4).asDiagonal());
  /// -m g (c + (1 + E / L) X), downwards along -y.
  class Gravity : public Term {
   public:
    Gravity(double weight, double lever) : weight_(weight), lever_(lever) {}
    std::string name() const override { return "gravity"; }
    Role role() const override { return Role::LOAD; }
    void evaluate(const Point& at, Order order, Sum& sum) const override {
      sum.energy += weight_ * (at.y(1) + at.y(3) * lever_ / LENGTH);
      if (order == Order::ENERGY) return;
      sum.gradient(1) += weight_;
      sum.gradient(3) += weight_ * lever_ / LENGTH;
      sum.noteForce(weight_);
    }

   private:
    double weight_, lever_;
  };
  const std::vector<Equation> hung = {{{{0, 1.0}}, {}, 0, "pivot"}, {{{1, 1.0}}, {}, 0, "pivot"}};
  auto coordinates = std::make_shared<const Coordinates>(Reduction(6, 0, hung), 2, std::vector<Rotation>{rotation});
  const auto inertia = std::make_shared<const RigidInertiaTerm>("bob", 2, 0, rotation, bob);
  const auto problem = std::make_shared<const TermProblem>(TermProblem::Parts{
      HessianLayout(6), coordinates, {inertia, std::make_shared<const Gravity>(mass * gravity, arm)}, 1, 0, 0});
  // The angle by fine steps of the equation of motion itself (Runge-Kutta).
  const double rate = mass * gravity * arm / (mass * arm * arm + 2e-4);
  double angle = 0, spin = 0;
  const auto slope = [&](double a) { return -rate * std::cos(a); };
  constexpr int FINE = 20000;
  for (int k = 0; k < FINE; ++k) {
    const double h = seconds / FINE, a1 = spin, b1 = slope(angle), a2 = spin + h / 2 * b1,
                 b2 = slope(angle + h / 2 * a1), a3 = spin + h / 2 * b2, b3 = slope(angle + h / 2 * a2),
                 a4 = spin + h * b3, b4 = slope(angle + h * a3);
    angle += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    spin += h / 6 * (b1 + 2 * b2 + 2 * b3 + b4);
  }
  const auto error = [&](Stepper::Test test, int steps) {
    Stepper stepper(problem, seconds / steps, test);
    stepper.run(steps);
    return std::abs(std::remainder(std::atan2(stepper.y(3), LENGTH + stepper.y(2)) - angle, 2 * std::acos(-1.0)));
  };
  const double mean = std::log2(error(Stepper::Test::MEAN, 200) / error(Stepper::Test::MEAN, 400));
  const double end = std::log2(error(Stepper::Test::END, 400) / error(Stepper::Test::END, 800));
  EXPECT_NEAR(mean, 2, 0.2);
  EXPECT_NEAR(end, 1, 0.2);
}

}  // namespace
}  // namespace snapwing::solver
