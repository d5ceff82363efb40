// Rigid bodies in pins and closed chains in time, with eliminated and with kept pins: against ordinary differential
// equations in the angles.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <functional>

#include "../solver/linkage.h"
#include "one_mode.h"

namespace snapwing::motion {
namespace {

using solver::testing_linkages::Bar;
using solver::testing_linkages::FourBar;
using solver::testing_linkages::GRAVITY;
using solver::testing_linkages::HUNG;
using solver::testing_linkages::Linkage;
using solver::testing_linkages::makeLinkage;
using solver::testing_linkages::PENDULUM;

/// Midpoint steps from rest, or from rates.
struct Moved {
  Moved(const Linkage& linkage, double h, const Scheme& scheme = Scheme(SchemeKind::MIDPOINT))
      : stepper(linkage.problem, scheme, test::equalSteps(h, 1e-12)), step(h) {
    state = stepper.start(Eigen::VectorXd::Zero(linkage.problem->freeCount()), Eigen::VectorXd());
  }
  void spin(const Eigen::VectorXd& rate) { state = stepper.start(state.z, Eigen::VectorXd(), rate); }
  void run(int steps) {
    for (int k = 0; k < steps; ++k) {
      // A step that needs more than 30 iterations is halved.
      while (state.time < (k + 1) * step) {
        iterations += stepper.step(state, (k + 1) * step, test::nothing()).iterations;
      }
    }
  }
  Stepper stepper;
  MotionState state;
  double step;
  int iterations = 0;
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

TEST(LinkagesInTime, DoublePendulumFollowsItsEquations) {
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
      Moved moved(linkage, SECONDS / (300 << k));
      moved.run(300 << k);
      const MotionState& s = moved.state;
      angle[k] = linkage.angle(s.y, 1);
      error[k] = std::max(apart(linkage.angle(s.y, 0), end(0)), apart(angle[k] + DOWN, end(1)));
      const double energy = s.kinetic + linkage.weights->energy(s.y);
      // What rounding of inertia leaves of forces, kappa M y times 1e-16, works over a step's way.
      EXPECT_NEAR(energy, linkage.weights->energy(0 * s.y), 1e-9 * s.kinetic);
    }
    EXPECT_NEAR(std::log2(error[1] / error[2]), 2, 0.1);
    EXPECT_LT(apart((4 * angle[2] - angle[1]) / 3 + DOWN, end(1)), 2e-3 * error[2]) << "extrapolated";
  }
}

TEST(LinkagesInTime, KeptPinsMoveAsEliminatedOnes) {
  Eigen::VectorXd end[2];
  for (const bool keep : {false, true}) {
    const Linkage linkage = makeLinkage(PENDULUM, HUNG, keep);
    Moved moved(linkage, 2e-3);
    moved.run(100);
    end[keep ? 1 : 0] = moved.state.y;
  }
  EXPECT_LT((end[0] - end[1]).norm(), 1e-9 * end[0].norm());
}

/// The crank's angle alone: M q'' + M' q'^2 / 2 + V' = 0, with M and V of the geometry.
TEST(LinkagesInTime, ClosedFourBarGoesRoundAsItsEquationSays) {
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
      Moved moved(linkage, SECONDS / (500 << k));
      const Eigen::VectorXd r = SPIN * rates(START);
      Eigen::VectorXd v = Eigen::VectorXd::Zero(moved.state.y.size());
      for (int bar = 0; bar < 3; ++bar) {  // of c, the displacement of the origin, and of E
        const Eigen::Vector2d centre = bars[bar].centre();
        v.segment(2 * bar, 2) = r.segment(2 * bar, 2) - r(6 + bar) * Eigen::Vector2d(-centre(1), centre(0));
        v.segment(6 + 4 * bar, 4) = solver::testing_linkages::LENGTH * r(6 + bar) * Eigen::Vector4d(0, 1, -1, 0);
      }
      moved.spin(v);
      const double kinetic = moved.state.kinetic;
      EXPECT_NEAR(kinetic, 0.5 * mass(START) * SPIN * SPIN, 1e-9 * kinetic);
      moved.run(500 << k);
      const MotionState& s = moved.state;
      angle[k] = linkage.angle(s.y, 0);
      error[k] = apart(angle[k] + START, end(0));
      EXPECT_NEAR(s.kinetic + linkage.weights->energy(s.y), kinetic, 1e-8 * kinetic);
      EXPECT_LT(moved.iterations, 8 * (500 << k));
    }
    EXPECT_NEAR(std::log2(error[0] / error[1]), 2, 0.1);
    EXPECT_LT(apart((4 * angle[1] - angle[0]) / 3 + START, end(0)), 1e-2 * error[1]) << "extrapolated";
  }
}

}  // namespace
}  // namespace snapwing::motion
