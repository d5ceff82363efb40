// What joins a wing's bars with a soft arm and with each other: derivatives, and what each does.
#include <gtest/gtest.h>

#include <cmath>

#include "one_mode.h"
#include "snapwing/common/error.h"
#include "snapwing/motion/wing_terms.h"
#include "support/term_check.h"

namespace snapwing::motion {
namespace {

constexpr double L = 0.05;
const Turning FIRST{0, 1, L}, SECOND{2, 3, L};

/// Entries of two bodies at angles a and b, a little off the circle as in the middle of a step.
Eigen::VectorXd at(double a, double b, double stretch = 1) {
  Eigen::VectorXd y(4);
  y << L * (stretch * std::cos(a) - 1), L * stretch * std::sin(a), L * (std::cos(b) - 1), L * std::sin(b);
  return y;
}

TEST(PinFriction, IsATermAndHoldsAgainstTheTurning) {
  const solver::Step step = test::stepFrom(at(0.4, -0.2));
  const PinFriction pin("pin", {FIRST, SECOND}, 2e-4, 0.6);
  test::TermCase c{solver::HessianLayout(4), {at(0.45, -0.1, 0.99), at(0.4, -0.21), at(0.4, -0.2)}};
  c.step = &step;
  c.scale = 1e-5;
  test::checkTerm(pin, c);
  EXPECT_THROW(PinFriction("pin", std::vector<Turning>(), 1, 1), common::Error);
  EXPECT_THROW(PinFriction("pin", {FIRST}, -1, 1), common::Error);
  EXPECT_THROW(PinFriction("pin", {FIRST}, 1, 0), common::Error);
}

/// Two bodies whose planes look at each other: what one counts as forwards is backwards for the other.
TEST(TurningAngle, IsThatByTheOtherBodyAlsoFromBehind) {
  Turning behind = SECOND;
  behind.sign = -1;
  const TurningAngle same("pin", {FIRST, SECOND}), against("pin", {FIRST, behind});
  EXPECT_NEAR(same.at(at(0.4, -0.3)), 0.7, 1e-12);
  EXPECT_NEAR(against.at(at(0.4, -0.3)), 0.1, 1e-12);
  EXPECT_NEAR(same.between(at(3.1, 3.0), at(-3.1, -3.0)), 2 * (3.0 - 3.1), 1e-12) << "through half a turn";
  const AngleEnergy flexure("flexure", {FIRST, behind}, SmoothCurve({-0.1, 0.2, 0.5, 1}, {1e-4, 0, 3e-4, 2e-3}));
  test::checkTerm(flexure, {solver::HessianLayout(4), {at(0.2, 0.11), at(0.8, -0.18, 0.98), at(0.4, 1)}});
  const solver::Step step = test::stepFrom(at(0.4, -0.2));
  const PinFriction pin("pin", {FIRST, behind}, 2e-4, 0.6);
  test::TermCase c{solver::HessianLayout(4), {at(0.45, -0.1, 0.99), at(0.4, -0.21)}};
  c.step = &step;
  c.scale = 1e-5;
  test::checkTerm(pin, c);
}

TEST(AngleEnergy, IsATermWithinAndBeyondItsPoints) {
  const AngleEnergy flexure("flexure", {FIRST}, SmoothCurve({-0.1, 0.2, 0.5, 1}, {1e-4, 0, 3e-4, 2e-3}));
  test::checkTerm(flexure, {solver::HessianLayout(4), {at(0.31, 0), at(0.62, 0, 0.98), at(1.4, 0), at(-0.4, 0)}});
  EXPECT_THROW(SmoothCurve({0, 0}, {0, 0}), common::Error);
  EXPECT_THROW(SmoothCurve({0}, {0}), common::Error);
  const SmoothCurve line({0, 1, 3}, {0, 2, 6});
  EXPECT_NEAR(line.at(1.7).value, 3.4, 1e-12);
  EXPECT_NEAR(line.at(5).value, 10, 1e-12);
}

TEST(TurningDrag, IsATermOfTheRateSquared) {
  const solver::Step step = test::stepFrom(at(0.4, -0.2));
  const TurningDrag air("air", {FIRST, SECOND}, 5e-5);
  test::TermCase c{solver::HessianLayout(4), {at(0.45, -0.1, 0.99), at(0.4, -0.21), at(0.43, -0.2)}};
  c.step = &step;
  c.scale = 1e-5;
  test::checkTerm(air, c);
  solver::HessianLayout layout(4);
  layout.addCouple({0, 1, 2, 3});
  solver::Sum sum;
  const std::vector<int> places{0};
  sum.reset(layout, 0, solver::Order::STRESS);
  sum.couples = &places;
  air.evaluate({at(0.44, -0.2), Eigen::VectorXd(), &step}, solver::Order::STRESS, sum);
  const double rate = 0.04 / step.h;  // the slope of an angle across its arm is 1 / L
  EXPECT_NEAR(sum.gradient.head<2>().norm(), 5e-5 * rate * rate / L, 1e-9);
  EXPECT_THROW(TurningDrag("air", {FIRST}, -1), common::Error);
}

TEST(TravelHub, IsATerm) {
  const SmoothCurve curve({0, 0.02, 0.05}, {0, 0.4, 0.9});
  const TravelHub hub("hub", {0, 1, L}, solver::Row({{2, 1.0}, {3, -1.0}}), curve, 30);
  Eigen::VectorXd y = at(0.4, 0);
  y(2) = 0.035, y(3) = 0.012;
  Eigen::VectorXd beyond = y;
  beyond(2) = 0.08;
  test::checkTerm(hub, {solver::HessianLayout(4), {y, beyond}});
  EXPECT_THROW(TravelHub("hub", {0, 1, L}, solver::Row({{2, 1.0}}), curve, 0), common::Error);
}

/// Four nodes on a circle of 4 mm, then the body, then the circle's centre.
TEST(HubTerm, IsATermAndMeasuresTheAngleBetweenArmAndCrank) {
  constexpr double R = 0.004, K = 20;
  const int full = 8 + 4 + 2, point = 12;
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(full);
  const auto place = [&](int n) { return Eigen::Vector2d(R * std::cos(1.6 * n + 0.3), R * std::sin(1.6 * n + 0.3)); };
  double square = 0;
  for (int n = 0; n < 4; ++n) square += place(n).squaredNorm();
  for (int n = 0; n < 4; ++n) gradient.segment<2>(2 * n) = Eigen::Vector2d(-place(n)(1), place(n)(0)) / square;
  const HubTerm hub("hub", gradient, {0, 2, 4, 6}, point, {8, 9, L}, K);
  const auto posed = [&](double arm, double crank, double rise) {
    Eigen::VectorXd y = Eigen::VectorXd::Zero(full);
    for (int n = 0; n < 4; ++n) {
      const Eigen::Vector2d x = place(n);
      y.segment<2>(2 * n) = Eigen::Vector2d(std::cos(arm) * x(0) - std::sin(arm) * x(1) - 0.4 * rise,
                                            std::sin(arm) * x(0) + std::cos(arm) * x(1) + rise) -
                            x;
    }
    y(8) = L * (std::cos(crank) - 1), y(9) = L * std::sin(crank), y(point) = -0.4 * rise, y(point + 1) = rise;
    return y;
  };
  EXPECT_NEAR(hub.twist(posed(0.9, 0.87, 0.3)), 0.03, 1e-12);
  test::checkTerm(hub,
                  {solver::HessianLayout(full), {posed(0.9, 0.87, 0.3), posed(-0.2, 0.1, 0), posed(0.5, 0.51, 0.1)}});
  EXPECT_THROW(HubTerm("hub", gradient, {}, point, {8, 9, L}, K), common::Error);
  EXPECT_THROW(HubTerm("hub", gradient, {0}, point, {8, 9, L}, 0), common::Error);
}

}  // namespace
}  // namespace snapwing::motion
