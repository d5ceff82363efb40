#include <gtest/gtest.h>

#include <cmath>

#include "plain_vehicle.h"
#include "quartic.h"
#include "snapwing/common/error.h"
#include "snapwing/rom/energy_spline.h"
#include "support/example_table.h"

namespace snapwing::rom {
namespace {

using testing::plainParameters;

LumpedModel splineModel(const vehicle::VehicleParameters& p, double idle = 0.0) {
  return LumpedModel(std::make_shared<EnergySpline>(snapwing::testing::exampleTable()), p, idle);
}

TEST(Integrator, KeepsEnergyAndMomentumWithoutLoadsAndLosses) {
  testing::expectInvariantsKept(splineModel(plainParameters()));
}

TEST(Integrator, SecondOrderInTime) {
  const auto travelAfter = [&](int count) {
    const LumpedModel model = splineModel(plainParameters());
    LumpedState state;
    state.travel = 0.004;
    for (int i = 0; i < count; ++i) state = model.step(state, 0.3, 0.2 / count, vehicle::Trial{});
    return state.travel;
  };
  const double exact = travelAfter(25600);
  const double coarse = std::abs(travelAfter(200) - exact), fine = std::abs(travelAfter(400) - exact);
  EXPECT_GT(coarse, 1e-9);
  EXPECT_NEAR(coarse / fine, 4.0, 0.4);
}

TEST(Integrator, EventTimeConvergesToAMicrosecond) {
  vehicle::Trial trial;
  trial.horizon = 10.0;
  const auto crossing = [&](double step) {
    return testing::quarticModel(0.6, step).predict(vehicle::Mode::FIXED_WING, 1.0, 5.0, trial).snap_time;
  };
  const double exact = crossing(2e-4);
  EXPECT_NEAR(crossing(1e-3), exact, 1e-6);
  EXPECT_NEAR(crossing(1.1e-3), exact, 1e-6);  // other steps around the event
}

TEST(Integrator, ThrustLagAndDragFollowClosedForms) {
  vehicle::VehicleParameters p = plainParameters();
  p.ring_drag = p.centre_drag = 0.01;  // equal accelerations, so that u stays small, is not needed: compare the sum
  p.time_constant_up = 0.04;
  const LumpedModel model = splineModel(p);
  LumpedState state;
  for (int i = 0; i < 100; ++i) state = model.step(state, 0.5, 1e-3, vehicle::Trial{});
  EXPECT_NEAR(state.thrust, 0.5 * 35.6 * (1.0 - std::exp(-0.1 / 0.04)), 1e-10);

  // Rigid limit: one stiff arm potential would be needed for m v' = T - k v^2; the terminal speed needs none.
  for (int i = 0; i < 40000; ++i) state = model.step(state, 0.5, 1e-3, vehicle::Trial{});
  EXPECT_NEAR(state.ring_speed, std::sqrt(0.5 * 35.6 / 0.02), 1e-6);
}

TEST(Integrator, GravityDropsOutOfTheRelativeMotionInFlight) {
  const LumpedModel model = splineModel(plainParameters());
  vehicle::Trial level, upright;
  upright.gravity = 9.81;
  const SnapPrediction a = model.predict(vehicle::Mode::FIXED_WING, 0.3, 0.1, level);
  const SnapPrediction b = model.predict(vehicle::Mode::FIXED_WING, 0.3, 0.1, upright);
  EXPECT_NEAR(a.peak_travel, b.peak_travel, 1e-9);
}

TEST(Integrator, HeldRingHangsTheCentreInTheArms) {
  vehicle::VehicleParameters p = plainParameters();
  p.damping = 4.0;
  const LumpedModel model = splineModel(p);
  vehicle::Trial trial;
  trial.mount = vehicle::Mount::HELD;
  trial.gravity = 5.0;
  bool held = false;
  const LumpedState rest = model.startState(vehicle::Mode::FIXED_WING, trial, &held);
  EXPECT_TRUE(held);
  EXPECT_NEAR(model.potential().at(rest.travel).force, 0.40 * 5.0, 1e-10);
  const SnapPrediction stays = model.predict(vehicle::Mode::FIXED_WING, 1.0, 0.3, trial);
  EXPECT_EQ(stays.end_mode, vehicle::Mode::FIXED_WING);  // thrust acts on the held ring only
  EXPECT_NEAR(stays.end_travel, rest.travel, 1e-9);
  // Inverted, the centre's 3.9 N pull it out of Q, whose valley is 2.2 N deep.
  trial.gravity = -9.81;
  const SnapPrediction falls = model.predict(vehicle::Mode::QUADROTOR, 0.0, 0.1, trial);
  EXPECT_FALSE(falls.start_held);
  EXPECT_EQ(falls.end_mode, vehicle::Mode::FIXED_WING);
}

TEST(Integrator, RefusesBadParameters) {
  vehicle::VehicleParameters p = plainParameters();
  p.ring_mass = 0;
  EXPECT_THROW(splineModel(p), common::Error);
  p = plainParameters();
  p.damping = NAN;
  EXPECT_THROW(splineModel(p), common::Error);
  EXPECT_THROW(splineModel(plainParameters(), 1.0), common::Error);
  EXPECT_THROW(LumpedModel(nullptr, plainParameters(), 0.0), common::Error);
  LumpedSettings settings;
  settings.step = 0.1;
  EXPECT_THROW(settings.validate(), common::Error);
}

}  // namespace
}  // namespace snapwing::rom
