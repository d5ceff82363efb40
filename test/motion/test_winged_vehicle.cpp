// The shipped vehicle with its wings' linkages on the soft arm: bodies, closed chains, agreement with the lumped model.
#include <gtest/gtest.h>

#include <cmath>

#include "restart.h"
#include "snapwing/common/error.h"
#include "snapwing/motion/axis_trial.h"
#include "snapwing/motion/trial_record.h"
#include "snapwing/rom/energy_spline.h"
#include "snapwing/rom/lumped_model.h"
#include "snapwing/scene/arm_scene.h"
#include "snapwing/solver/load_term.h"
#include "snapwing/vehicle/table_origin.h"
#include "support/paths.h"

namespace snapwing::motion {
namespace {

struct Shipped {
  vehicle::Vehicle vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  vehicle::ForceTable table = vehicle::armTableOf(vehicle);
  vehicle::WingTable wing = *vehicle::wingTableOf(vehicle, table);
  vehicle::VehicleParameters parameters = vehicle::realise(vehicle, table);
};

vehicle::Trial winged(double gravity = 0) {
  vehicle::Trial trial;
  trial.gravity = gravity;
  trial.wings = true;
  trial.initial_thrust_fraction = 0.0;
  trial.horizon = 2;
  return trial;
}

AxisSettings coarse() {
  AxisSettings settings;
  settings.wing_stop = 0;
  settings.cell_size = 0.0025;
  return settings;
}

TEST(WingLinkage, ClosesAsTheTableSaysAndItsRatesAreThoseOfItsAngles) {
  const Shipped s;
  const WingLinkage linkage(s.wing, s.vehicle.wing.layout_file, 1, 1);
  for (std::size_t k = 0; k < s.wing.travel.size(); k += 7) {
    const LinkagePose pose = linkage.at(s.wing.arm_rotation[k]);
    EXPECT_NEAR(pose.wing, s.wing.wing_angle[k], 1e-9);
    EXPECT_NEAR(pose.rocker, s.wing.rocker_angle[k], 1e-9);
    EXPECT_NEAR(pose.wing_rate, s.wing.transmission_ratio[k], 1e-7);
  }
  constexpr double H = 1e-5;
  for (const double crank : {-0.05, 0.1, 0.35, 0.8, 1.02}) {
    EXPECT_NEAR((linkage.at(crank + H).rocker - linkage.at(crank - H).rocker) / (2 * H), linkage.at(crank).rocker_rate,
                1e-7);
  }
  EXPECT_THROW(linkage.at(3), common::Error);
  // A fan that folds is no rigid body: 5 % of the largest K.
  EXPECT_LT(linkage.bladeError(), 0.06);
  EXPECT_NEAR(linkage.totalMass(), 0.019, 0.002);
  EXPECT_NEAR(WingLinkage(s.wing, s.vehicle.wing.layout_file, 2, 3).inertia(0.3)[0], 2 * linkage.inertia(0.3)[0],
              1e-12);
}

TEST(WingedVehicle, HasTheVehiclesMassAndFallsAsOneBody) {
  const Shipped s;
  const AxisVehicle vehicle(s.vehicle, s.parameters, winged(9.81), coarse(), s.wing);
  Stepper stepper(vehicle.problem(), Scheme(SchemeKind::MIDPOINT), {});
  MotionState state = vehicle.start(vehicle::Mode::FIXED_WING, 0);
  const ControlOf none = [](double, double) { return Eigen::VectorXd::Zero(1); };
  while (state.time < 0.01) stepper.step(state, 0.01, none);
  EXPECT_NEAR(vehicle.ringSpeed(state), -0.0981, 1e-5);
  EXPECT_NEAR(vehicle.travelRate(state), 0, 1e-5);
  const double whole = s.parameters.ring_mass + s.parameters.centre_mass;
  EXPECT_NEAR(state.kinetic / vehicle.shareOfVehicle(), 0.5 * whole * 0.0981 * 0.0981, 1e-3 * whole * 0.0981 * 0.0981);
}

TEST(WingedVehicle, RefusesABoomAndAVehicleWithoutWings) {
  const Shipped s;
  vehicle::Trial boom = winged();
  boom.mount = vehicle::Mount::BOOM;
  EXPECT_THROW(AxisVehicle(s.vehicle, s.parameters, boom, coarse(), s.wing), common::Error);
  EXPECT_THROW(AxisVehicle(s.vehicle, s.parameters, winged(), coarse()), common::Error);
}

struct Flown {
  AxisRun run;
  double twist = 0;            ///< [rad] largest between crank and arm
  double furthest_back = 0;    ///< [rad] least rotation of the left wing
  double apart = 0;            ///< [rad] largest between both wings
  rom::SnapPrediction lumped;  ///< on the same static curve, with the same bars
};

Flown fly(const Shipped& s, const AxisSettings& settings, double fraction, double duration, double horizon = 2,
          double after = 0, double step = 1e-3) {
  vehicle::Trial around = winged();
  around.horizon = horizon;
  around.final_thrust_fraction = after;
  const AxisVehicle vehicle(s.vehicle, s.parameters, around, settings, s.wing);
  StepperSettings steps;
  steps.largest_step = step;
  steps.relative_tolerance = 1e-6;
  Stepper stepper(vehicle.problem(), Scheme(SchemeKind::MIDPOINT), steps);
  Flown out;
  AxisRunHooks hooks;
  hooks.stepped = [&](const AxisRun& now) {
    const AxisSample& sample = now.samples.back();
    out.twist = std::max(out.twist, sample.hub_twist);
    out.furthest_back = std::min(out.furthest_back, sample.wing_left);
    out.apart = std::max(out.apart, std::abs(sample.wing_left - sample.wing_right));
    return true;
  };
  const AxisTrial trial = AxisTrial::of(vehicle::Mode::FIXED_WING, fraction, duration, s.parameters, 0, around);
  EXPECT_TRUE(runTrial(vehicle, stepper, trial, out.run, hooks));
  const vehicle::ForceTable table = vehicle.staticTable();
  const auto arms = std::make_shared<rom::TravelInertia>(table);
  // Friction's rounding is a rate of angles here and a speed there: without friction there is no such question.
  const auto wings = std::make_shared<rom::TravelInertia>(vehicle.staticWingTable());
  const rom::LumpedModel lumped(std::make_shared<rom::EnergySpline>(table), s.parameters, 0, {}, wings, arms);
  out.lumped = lumped.predict(vehicle::Mode::FIXED_WING, fraction, duration, around);
  return out;
}

/// Tied to the travel, the bars in their pins do what the lumped model makes of K(u) and S(u): another way of counting
/// inertia, another integrator, the soft arm's own motion besides.
TEST(WingedVehicle, TiedToTheTravelIsTheLumpedModel) {
  const Shipped s;
  AxisSettings settings = coarse();
  settings.wings_follow_travel = true;
  settings.friction_left = settings.friction_right = 0;
  Shipped smooth = s;
  smooth.parameters.wing_friction = 0;
  const Flown flown = fly(smooth, settings, 0.583, 0.286);
  const AxisOutcome& o = flown.run.outcome;
  EXPECT_EQ(o.end_mode, vehicle::Mode::QUADROTOR);
  EXPECT_EQ(flown.lumped.end_mode, vehicle::Mode::QUADROTOR);
  // The soft arm's own modes: as without wings, docs/motion.md.
  EXPECT_NEAR(o.snap_time, flown.lumped.snap_time, 5e-4);
  EXPECT_NEAR(o.peak_travel, flown.lumped.peak_travel, 2e-4);
  EXPECT_LT(o.largest_imbalance, 5e-4);
}

/// With wings of a hundredth of their mass the soft arm carries nothing, and nothing turns it back.
TEST(WingedVehicle, LightWingsOnTheSoftArmAreTheLumpedModel) {
  Shipped s;
  s.parameters.wing_inertia = 0.01;
  s.parameters.wing_friction = 0;
  const Flown flown = fly(s, coarse(), 0.55, 0.12);
  const AxisOutcome& o = flown.run.outcome;
  EXPECT_EQ(o.end_mode, vehicle::Mode::QUADROTOR);
  EXPECT_NEAR(o.snap_time, flown.lumped.snap_time, 5e-4);
  EXPECT_NEAR(o.peak_travel, flown.lumped.peak_travel, 2e-4);
}

/// Real ones turn it: the arm's end is far softer than what holds the wings while the ring accelerates.
TEST(WingedVehicle, TheWingsLoadTurnsTheSoftArmBack) {
  const Shipped s;
  const Flown flown = fly(s, coarse(), 0.583, 0.05, 0.1);
  EXPECT_LT(flown.furthest_back, -0.2);
  EXPECT_LT(flown.twist, 1e-3) << "the crank follows the arm";
  EXPECT_LT(flown.run.outcome.largest_imbalance, 1e-3);
}

/// With steps of 1 ms and a hard stop the midpoint rule feeds more energy than a barrier needs: no answer, and why.
TEST(WingedVehicle, WhatTheSchemeFedIsNoAnswer) {
  const Shipped s;
  AxisSettings settings = coarse();
  settings.wing_stop = 50;
  try {
    fly(s, settings, 0.583, 0.286, 1);
    FAIL() << "an answer";
  } catch (const common::Error& error) {
    EXPECT_NE(std::string(error.what()).find("added or removed"), std::string::npos) << error.what();
  }
}

/// A pulse that is cut to idle lets the housing fall back over the barrier, as long as the wings swing; steady thrust
/// after it keeps it beyond.
TEST(WingedVehicle, ThrustAfterThePulseKeepsTheHousingBeyondTheBarrier) {
  const Shipped s;
  AxisSettings settings = coarse();
  settings.wing_stop = 10;
  const double barrier = AxisVehicle(s.vehicle, s.parameters, winged(), settings, s.wing).curve().barrier();
  for (const double after : {0.0, 0.2}) {
    SCOPED_TRACE(after);
    const Flown flown = fly(s, settings, 0.583, 0.286, 0.18, after, 5e-4);
    double least = 1;
    for (const AxisSample& sample : flown.run.samples) {
      if (sample.time > 0.2) least = std::min(least, sample.travel);  // the barrier is passed at 124 ms
    }
    EXPECT_EQ(least > barrier, after > 0) << least;
  }
}

TEST(WingedVehicle, AStopHoldsTheWingsAtRest) {
  const Shipped s;
  AxisSettings settings = coarse();
  settings.wing_stop = 50;
  const Flown flown = fly(s, settings, 0.583, 0.05, 0.1);
  EXPECT_GT(flown.furthest_back, -0.02);
  EXPECT_LT(flown.run.outcome.largest_imbalance, 1e-3);
}

/// That softness by itself: at rest with thrust, the wings' weight in the accelerating vehicle against a moment on the
/// arm's material about its axle, solved by the static solver without any wing.
TEST(WingedVehicle, ArmsRotationUnderTheWingsIsThatOfAStaticMoment) {
  const Shipped s;
  const vehicle::ArmSettings& arm = s.vehicle.arm;
  mpm::DensityField field =
      mpm::loadDensityCsv(arm.density_file, arm.domain_length, arm.domain_height).resampled(0.0025);
  for (double& value : field.value) {
    if (value < AxisSettings().least_density) value = -1;
  }
  const auto scene = scene::compileScene(scene::armScene(s.vehicle, field, {}), 1);
  constexpr double MOMENT = -1e-4;  // [N m] on one arm
  Eigen::VectorXd gradient;
  scene->monitor(0, Eigen::VectorXd::Zero(scene->terms().coordinates().fullCount()), &gradient);
  const auto loaded = scene->terms().with({std::make_shared<solver::LoadTerm>(MOMENT * gradient, Eigen::MatrixXd())});
  solver::EquilibriumSolver solver(*loaded, {});
  solver::Equilibrium x = solver.start(Eigen::VectorXd::Zero(loaded->freeCount()), 0);
  ASSERT_TRUE(solver.minimise(x).converged());
  const double softness = scene->monitors(x.z, 0)[0] / MOMENT;  // [rad / N m]
  // A tenth of the wings' mass, so that the arm turns little; accelerated by .5 N.
  Shipped light = s;
  light.parameters.wing_inertia = 0.1;
  const AxisVehicle vehicle(light.vehicle, light.parameters, winged(), coarse(), light.wing);
  bool held = false;
  const MotionState state = vehicle.start(vehicle::Mode::FIXED_WING, 0.5, &held);
  ASSERT_TRUE(held);
  const double acceleration = 0.5 / (light.parameters.ring_mass + light.parameters.centre_mass);
  const double expected = -softness * acceleration * vehicle.linkage()->inertia(0)[1];
  // Beside what the arm turns along its static path.
  AxisSettings tied = coarse();
  tied.wings_follow_travel = true;
  const AxisVehicle path(light.vehicle, light.parameters, winged(), tied, light.wing);
  const double along = path.armRotation(path.start(vehicle::Mode::FIXED_WING, 0.5));
  EXPECT_NEAR(vehicle.armRotation(state) - along, expected, 0.05 * std::abs(expected));
}

/// Left and right with other pins are two arms; with the same pins two arms move as the one that stands for both.
TEST(WingedVehicle, UnevenFrictionMovesTheWingsApart) {
  const Shipped s;
  AxisSettings even = coarse(), uneven = coarse(), nearly = coarse();
  uneven.friction_right = 20;
  nearly.friction_right = 1 + 1e-9;
  const Flown one = fly(s, even, 0.4, 0.02, 0.1), two = fly(s, nearly, 0.4, 0.02, 0.1),
              other = fly(s, uneven, 0.4, 0.02, 0.1);
  EXPECT_EQ(one.apart, 0);
  EXPECT_LT(two.apart, 1e-4);
  EXPECT_NEAR(two.run.outcome.peak_travel, one.run.outcome.peak_travel, 1e-7);
  EXPECT_GT(other.apart, 0.02);
}

TEST(WingedVehicle, AStoppedRunGoesOnWithTheSameBits) {
  const Shipped s;
  const AxisVehicle vehicle(s.vehicle, s.parameters, winged(), coarse(), s.wing);
  vehicle::Trial around = winged();
  around.horizon = 0.1;
  const AxisTrial trial = AxisTrial::of(vehicle::Mode::QUADROTOR, 0.5, 0.05, s.parameters, 0, around);
  StepperSettings steps;
  steps.largest_step = 2e-3;
  EXPECT_EQ(test::restarted(vehicle, trial, steps, 20, 47, "winged_checkpoint.bin").steps_of_checkpoint, 40);
}

}  // namespace
}  // namespace snapwing::motion
