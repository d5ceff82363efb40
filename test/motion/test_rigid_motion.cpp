// Rigid bodies where steps are hard: a free one that turns a hundred times, a chain at its dead point.
#include <gtest/gtest.h>

#include <cmath>

#include "../solver/linkage.h"
#include "one_mode.h"
#include "snapwing/common/error.h"

namespace snapwing::motion {
namespace {

using solver::testing_linkages::Linkage;
using solver::testing_linkages::makeLinkage;

constexpr double LENGTH = 0.05;

/// Entries of E or of its rate as a matrix.
Eigen::Matrix3d matrixOf(const Eigen::VectorXd& full) { return Eigen::Map<const Eigen::Matrix3d>(full.data() + 3); }

/// Torque-free, asymmetric, spun about a little off its middle axis: it tumbles.
TEST(FreeBody, TurnsAHundredTimesAndKeepsAllThatIsKept) {
  const solver::Rotation rotation{
      3, LENGTH, {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()}};
  const Eigen::Vector3d centre(0.01, -0.02, 0.005);
  const auto body = std::make_shared<const solver::RigidInertiaTerm>(
      "body", 3, 0, rotation, solver::RigidMass::of(0.2, centre, Eigen::Vector3d(1e-4, 1.6e-4, 2.2e-4).asDiagonal()));
  auto coordinates = std::make_shared<const solver::Coordinates>(solver::Reduction(12, 0, {}, 3), 3,
                                                                 std::vector<solver::Rotation>{rotation});
  const auto problem = std::make_shared<const solver::TermProblem>(
      solver::TermProblem::Parts{solver::HessianLayout(12), coordinates, {body}, 1, 1e-13, 0});
  constexpr double H = 0.02, SPIN = 20;
  const int steps = static_cast<int>(100 * 2 * M_PI / SPIN / H) + 1;
  StepperSettings settings = test::equalSteps(H, 1e-15);
  settings.roundings = 1;  // tighter than where Newton's method usually stops: 1600 steps add up
  Stepper stepper(problem, Scheme(SchemeKind::MIDPOINT), settings);
  Eigen::VectorXd rate = Eigen::VectorXd::Zero(12);
  rate.head<3>() = Eigen::Vector3d(0.02, 0.01, -0.01);
  const Eigen::Matrix3d spin = LENGTH * solver::skewOf(Eigen::Vector3d(1, SPIN, 1));
  Eigen::Map<Eigen::Matrix3d>(rate.data() + 3) = spin;
  MotionState state = stepper.start(Eigen::VectorXd::Zero(problem->freeCount()), Eigen::VectorXd(), rate);
  const double energy = state.kinetic;
  // About the place where the centre of mass is now: that about a fixed point changes with it.
  const auto angular = [&](const MotionState& s) {
    const Eigen::Vector3d place = centre + s.y.head<3>() + matrixOf(s.y) * centre / LENGTH;
    return Eigen::Vector3d(body->angularMomentum(s.y, s.v) - place.cross(body->momentum(s.v)));
  };
  const Eigen::Vector3d linear = body->momentum(state.v), about = angular(state);
  const double speed = 0.2 * SPIN * 0.03;  // of its points, times the mass [kg m/s]
  double worst_energy = 0, worst_linear = 0, worst_angular = 0, worst_shape = 0, turned = 0;
  for (int k = 0; k < steps; ++k) {
    const Eigen::Matrix3d before = Eigen::Matrix3d::Identity() + matrixOf(state.y) / LENGTH;
    while (state.time < (k + 1) * H) stepper.step(state, (k + 1) * H, test::nothing());
    const Eigen::Matrix3d now = Eigen::Matrix3d::Identity() + matrixOf(state.y) / LENGTH;
    turned += std::acos(std::min(1.0, 0.5 * ((now * before.transpose()).trace() - 1)));
    worst_energy = std::max(worst_energy, std::abs(state.kinetic / energy - 1));
    worst_linear = std::max(worst_linear, (body->momentum(state.v) - linear).norm() / speed);
    worst_angular = std::max(worst_angular, (angular(state) - about).norm() / about.norm());
    worst_shape = std::max(worst_shape, (now.transpose() * now - Eigen::Matrix3d::Identity()).norm());
  }
  EXPECT_GT(turned, 100 * 2 * M_PI * 0.9);
  EXPECT_LT(worst_energy, 1e-10);
  EXPECT_LT(worst_linear, 1e-10);
  EXPECT_LT(worst_angular, 1e-10);
  EXPECT_LT(worst_shape, 1e-13);
}

/// A parallelogram whose bars all lie in one line has two ways on, and its pins hold one motion twice. The run stops
/// there and says when; what it leaves is the last state that held.
TEST(DeadPoint, AParallelogramStopsThereAndSaysSo) {
  constexpr double CRANK = 0.03, GROUND = 0.07, SPIN = 20;
  const auto bars = [&](double theta) {
    const Eigen::Vector2d a(CRANK * std::cos(theta), CRANK * std::sin(theta)), g(GROUND, 0);
    return std::vector<solver::testing_linkages::Bar>{
        {Eigen::Vector2d::Zero(), a, 0.05}, {a, g + a, 0.09}, {g, g + a, 0.07}};
  };
  const auto start = bars(2.2);
  const Linkage linkage = makeLinkage(start,
                                      {{"ground left", 0, -1, start[0].from},
                                       {"crank pin", 0, 1, start[0].to},
                                       {"rocker pin", 1, 2, start[1].to},
                                       {"ground right", 2, -1, start[2].from}},
                                      false);
  Stepper stepper(linkage.problem, Scheme(SchemeKind::MIDPOINT), test::equalSteps(1e-3, 1e-11));
  MotionState state = stepper.start(Eigen::VectorXd::Zero(linkage.problem->freeCount()), Eigen::VectorXd());
  Eigen::VectorXd v = Eigen::VectorXd::Zero(state.y.size());
  for (const int bar : {0, 2}) {  // both turn, the coupler is carried along
    const Eigen::Vector2d pivot = start[bar].from;
    v.segment<2>(2 * bar) = SPIN * Eigen::Vector2d(pivot(1), -pivot(0));
    v.segment<4>(6 + 4 * bar) = solver::testing_linkages::LENGTH * SPIN * Eigen::Vector4d(0, 1, -1, 0);
  }
  v.segment<2>(2) = SPIN * Eigen::Vector2d(-start[0].to(1), start[0].to(0));
  state = stepper.start(state.z, Eigen::VectorXd(), v);
  const double energy = state.kinetic + linkage.weights->energy(state.y);
  std::string reason;
  try {
    while (state.time < 0.2) stepper.step(state, 0.2, test::nothing());
  } catch (const common::Error& error) {
    reason = error.what();
  }
  EXPECT_NE(reason.find("the motion failed at 0.037"), std::string::npos) << reason;
  EXPECT_NEAR(2.2 + linkage.angle(state.y, 0), M_PI, 1e-3);
  EXPECT_TRUE(state.y.allFinite() && state.v.allFinite());
  EXPECT_NEAR(state.kinetic + linkage.weights->energy(state.y), energy, 1e-6 * energy);
}

}  // namespace
}  // namespace snapwing::motion
