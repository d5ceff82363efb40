// Schemes on one mode and on the quartic double well, against closed forms.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "one_mode.h"
#include "snapwing/common/error.h"
#include "snapwing/solver/load_term.h"

namespace snapwing::motion {
namespace {

using solver::Order;
using solver::Point;
using solver::Term;
using test::nothing;
using test::only;

/// Mass 1 on a spring of stiffness w^2 with c = 2 zeta w.
std::shared_ptr<const solver::TermProblem> oscillator(double w, double zeta) {
  return test::pointMasses(1, {std::make_shared<solver::RowInertia>("mass", only(0), 1.0),
                               std::make_shared<solver::RowSpring>("spring", only(0), w * w),
                               std::make_shared<solver::RowDamper>("damper", only(0), 2 * zeta * w)});
}

/// Amplification per step of the scheme, |largest eigenvalue| of the map (y, v) -> (y, v).
double amplification(const Scheme& scheme, double w, double zeta, double h) {
  Stepper stepper(oscillator(w, zeta), scheme, test::equalSteps(h, 1e-12));
  Eigen::Matrix2d map;
  for (int column = 0; column < 2; ++column) {
    const Eigen::VectorXd y = Eigen::VectorXd::Constant(1, column == 0 ? 1.0 : 0.0),
                          v = Eigen::VectorXd::Constant(1, column == 1 ? 1.0 : 0.0);
    MotionState state = stepper.start(y, Eigen::VectorXd(), v);
    stepper.step(state, h, nothing());
    map.col(column) << state.y(0), state.v(0);
  }
  return map.eigenvalues().cwiseAbs().maxCoeff();
}

/// 1/sqrt(1 + 2 zeta w h + (w h)^2) a step, zeta = gamma w / 2 (docs/references.md).
TEST(BackwardEuler, DampsOneModeAsInClosedForm) {
  const double w = 7.0;
  for (const auto& [zeta, wh, decrement] : {std::tuple{0.0, 0.1, 0.313638}, std::tuple{0.0, 0.05, 0.157014},
                                            std::tuple{0.05, 0.05, 0.471633}, std::tuple{0.18, 0.05, 1.308900}}) {
    const double factor = amplification(Scheme(SchemeKind::BACKWARD_EULER), w, zeta, wh / w);
    EXPECT_NEAR(factor, 1 / std::sqrt(1 + 2 * zeta * wh + wh * wh), 1e-9);
    // Logarithmic decrement of a whole cycle of the damped mode, as tabulated.
    Eigen::Vector2cd unused;
    const double angle = std::atan2(wh * std::sqrt(1 - zeta * zeta), 1 + zeta * wh);
    EXPECT_NEAR(-std::log(factor) * 2 * std::acos(-1.0) / angle, decrement, 1e-5);
  }
}

TEST(Midpoint, KeepsTheAmplitudeOfAnUndampedMode) {
  for (const SchemeKind kind : {SchemeKind::MIDPOINT, SchemeKind::AVERAGE_FORCE}) {
    EXPECT_NEAR(amplification(Scheme(kind), 7, 0, 0.1), 1, 1e-12);
  }
  EXPECT_LT(amplification(Scheme(SchemeKind::MIDPOINT, 2, 0.1), 7, 0, 0.1), 0.99) << "the bias damps";
}

/// V = ((x - 1)^2 - 1)^2 / 4: states 0 and 2, barrier 1/4.
class Quartic : public Term {
 public:
  std::string name() const override { return "double well"; }
  Role role() const override { return Role::STORED; }
  std::vector<std::vector<int>> couples() const override { return {{0}}; }
  void evaluate(const Point& at, Order order, solver::Sum& sum) const override {
    const double x = at.y(0) - 1, w = x * x - 1;
    sum.energy += 0.25 * w * w;
    sum.stored += 0.25 * w * w;
    if (order == Order::ENERGY) return;
    sum.gradient(0) += w * x;
    sum.noteForce(std::abs(w * x));
    if (elasticity::withTangent(order)) {
      const double curvature = 3 * x * x - 1;
      sum.addRankOne(0, order == Order::PROJECTED ? std::max(0.0, curvature) : curvature, Eigen::VectorXd::Ones(1));
    }
  }
};

std::shared_ptr<const solver::TermProblem> doubleWell() {
  return test::pointMasses(1,
                           {std::make_shared<solver::RowInertia>("mass", only(0), 1.0), std::make_shared<Quartic>(),
                            std::make_shared<solver::LoadTerm>(Eigen::VectorXd(), Eigen::MatrixXd::Ones(1, 1))},
                           1);
}

/// Energy that a pulse leaves at the end, from a state at rest; above 1/4 it crosses.
double energyAfter(const Scheme& scheme, double from, double force, double duration, double h) {
  Stepper stepper(doubleWell(), scheme, test::equalSteps(h, 1e-12));
  MotionState state = stepper.start(Eigen::VectorXd::Constant(1, from), Eigen::VectorXd::Zero(1));
  const ControlOf pulse = [&](double, double) { return Eigen::VectorXd::Constant(1, force); };
  StepAccount account;
  while (state.time < duration) account = stepper.step(state, duration, pulse);
  return account.kinetic + account.stored;
}

/// Thresholds of rectangular pulses, docs/references.md. Within 1 %.
TEST(Schemes, FindTheThresholdPulsesOfTheQuartic) {
  constexpr double STATIC_LIMIT = 0.384900;
  for (const Scheme& scheme : {Scheme(SchemeKind::MIDPOINT), Scheme(SchemeKind::AVERAGE_FORCE, 2)}) {
    for (const auto& [share, duration] :
         {std::pair{0.8, 4.928359}, std::pair{1.0, 2.520404}, std::pair{1.5, 1.379954}, std::pair{2.0, 0.980615},
          std::pair{3.0, 0.630413}, std::pair{10.0, 0.184212}}) {
      const double h = duration / 400, force = share * STATIC_LIMIT;
      EXPECT_LT(energyAfter(scheme, 0, force, 0.99 * duration, h), 0.25) << share;
      EXPECT_GT(energyAfter(scheme, 0, force, 1.01 * duration, h), 0.25) << share;
    }
    for (const auto& [share, first, last] :
         {std::tuple{2.0, 1.026201, 2.251293}, std::tuple{3.0, 0.636621, 2.392453}}) {
      const double h = first / 400, force = share * STATIC_LIMIT;
      EXPECT_LT(energyAfter(scheme, 2, force, 0.99 * first, h), 0.25) << share;
      EXPECT_GT(energyAfter(scheme, 2, force, 1.01 * first, h), 0.25) << share;
      EXPECT_GT(energyAfter(scheme, 2, force, 0.99 * last, h), 0.25) << share;
      EXPECT_LT(energyAfter(scheme, 2, force, 1.01 * last, h), 0.25) << share;
    }
  }
}

/// What the scheme added or removed over free swings: nothing for two Gauss points on a quartic (exact to degree 3 in
/// s).
TEST(AverageForce, KeepsTheEnergyOfTheQuarticToRounding) {
  Stepper stepper(doubleWell(), Scheme(SchemeKind::AVERAGE_FORCE, 2), test::equalSteps(0.05, 1e-12));
  MotionState state = stepper.start(Eigen::VectorXd::Constant(1, 0.2), Eigen::VectorXd::Zero(1));
  const ControlOf idle = [](double, double) { return Eigen::VectorXd::Zero(1); };
  const double before = state.stored;
  double worst = 0;
  for (int k = 0; k < 1000; ++k) {
    const StepAccount account = stepper.step(state, state.time + 0.05, idle);
    worst = std::max(worst, std::abs(account.kinetic + account.stored - before));
  }
  EXPECT_LT(worst, 1e-11);
}

TEST(Schemes, HaveTheirOrder) {
  const auto end = [](const Scheme& scheme, int steps) {
    Stepper stepper(doubleWell(), scheme, test::equalSteps(4.0 / steps, 1e-12));
    MotionState state = stepper.start(Eigen::VectorXd::Constant(1, 0.3), Eigen::VectorXd::Zero(1));
    const ControlOf load = [](double, double) { return Eigen::VectorXd::Constant(1, 0.1); };
    while (state.time < 4.0) stepper.step(state, 4.0, load);
    return state.y(0);
  };
  const auto order = [&](const Scheme& scheme) {
    const double a = end(scheme, 400), b = end(scheme, 800), c = end(scheme, 1600);
    return std::log2(std::abs((a - b) / (b - c)));
  };
  EXPECT_NEAR(order(Scheme(SchemeKind::BACKWARD_EULER)), 1, 0.2);
  EXPECT_NEAR(order(Scheme(SchemeKind::MIDPOINT)), 2, 0.2);
  EXPECT_NEAR(order(Scheme(SchemeKind::AVERAGE_FORCE)), 2, 0.2);
  EXPECT_NEAR(order(Scheme(SchemeKind::CORRECTED_MIDPOINT)), 2, 0.2);
}

/// The local error that is told is the one that was made: halved steps cut it to an eighth.
TEST(Stepper, ChoosesStepsByTheirError) {
  StepperSettings settings = test::equalSteps(0.2, 1e-12);
  settings.error = 1e-5;
  settings.smallest_step = 1e-5;
  Stepper chosen(doubleWell(), Scheme(SchemeKind::MIDPOINT), settings);
  MotionState state = chosen.start(Eigen::VectorXd::Constant(1, 0.3), Eigen::VectorXd::Zero(1));
  const ControlOf idle = [](double, double) { return Eigen::VectorXd::Zero(1); };
  int steps = 0;
  double worst = 0, smallest = 1, largest = 0;
  while (state.time < 10) {
    const StepAccount account = chosen.step(state, 10, idle);
    worst = std::max(worst, account.error);
    smallest = std::min(smallest, account.h), largest = std::max(largest, account.h);
    ++steps;
  }
  EXPECT_LE(worst, 1e-5);
  EXPECT_LT(smallest, largest);
  Stepper fine(doubleWell(), Scheme(SchemeKind::MIDPOINT), test::equalSteps(1e-3, 1e-12));
  MotionState truth = fine.start(Eigen::VectorXd::Constant(1, 0.3), Eigen::VectorXd::Zero(1));
  while (truth.time < 10) fine.step(truth, 10, idle);
  EXPECT_NEAR(state.y(0), truth.y(0), 2.0 * steps * 1e-5);
  EXPECT_EQ(state.time, 10);
}

TEST(Stepper, RefusesWhatHasNoMassAndSettingsOutOfRange) {
  EXPECT_THROW(Stepper(test::pointMasses(1, {std::make_shared<solver::RowSpring>("spring", only(0), 1.0)}),
                       Scheme(SchemeKind::MIDPOINT), {}),
               common::Error);
  EXPECT_THROW(Scheme(SchemeKind::AVERAGE_FORCE, 5), common::Error);
  EXPECT_THROW(Scheme(SchemeKind::BACKWARD_EULER, 2, 0.1), common::Error);
  EXPECT_THROW(schemeFromName("euler"), common::Error);
  StepperSettings bad;
  bad.largest_step = -1;
  EXPECT_THROW(Stepper(oscillator(1, 0), Scheme(SchemeKind::MIDPOINT), bad), common::Error);
}

}  // namespace
}  // namespace snapwing::motion
