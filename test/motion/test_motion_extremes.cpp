// The soft arm at the edge of what can be asked: each run ends in an answer or in a reason, and nothing is NaN.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "snapwing/common/error.h"
#include "snapwing/motion/axis_trial.h"
#include "snapwing/vehicle/table_origin.h"
#include "support/paths.h"

namespace snapwing::motion {
namespace {

struct Extreme {
  const char* name;
  double fraction, duration, step, horizon;
  std::function<void(vehicle::VehicleParameters&, vehicle::Trial&)> change;
};

/// @return "" after an answer, else the reason
std::string run(const Extreme& extreme) {
  const vehicle::Vehicle vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  vehicle::VehicleParameters parameters = vehicle::realise(vehicle, vehicle::armTableOf(vehicle));
  vehicle::Trial trial;
  trial.mount = vehicle::Mount::FREE;
  trial.wings = false;
  trial.initial_thrust_fraction = 0.0;
  trial.horizon = extreme.horizon;
  extreme.change(parameters, trial);
  AxisSettings settings;
  settings.cell_size = 0.0025;
  StepperSettings steps;
  steps.largest_step = extreme.step;
  steps.relative_tolerance = 1e-6;
  AxisRun result;
  std::string reason;
  try {
    const AxisVehicle soft(vehicle, parameters, trial, settings);
    Stepper stepper(soft.problem(), Scheme(SchemeKind::MIDPOINT), steps);
    runTrial(soft, stepper,
             AxisTrial::of(vehicle::Mode::FIXED_WING, extreme.fraction, extreme.duration, parameters, 0, trial),
             result);
  } catch (const common::Error& error) {
    reason = error.what();
    EXPECT_NE(reason.find("failed at"), std::string::npos) << extreme.name << ": " << reason;
  }
  for (const AxisSample& sample : result.samples) {
    EXPECT_TRUE(std::isfinite(sample.travel) && std::isfinite(sample.kinetic) && std::isfinite(sample.stored) &&
                std::isfinite(sample.imbalance))
        << extreme.name << " at " << sample.time;
  }
  EXPECT_GT(result.samples.size(), 1u) << extreme.name;
  return reason;
}

TEST(MotionExtremes, EndInAnAnswer) {
  using P = vehicle::VehicleParameters;
  using T = vehicle::Trial;
  const std::vector<Extreme> cases = {
      {"steps of 10 us", 1, 0.005, 1e-5, 0.01, [](P&, T&) {}},
      {"steps of 5 ms", 0.5, 0.06, 0.005, 2, [](P&, T&) {}},
      {"full thrust in one step", 1, 0.03, 5e-4, 2, [](P& p, T&) { p.time_constant_up = p.time_constant_down = 1e-6; }},
      {"no damping", 0.5, 0.06, 5e-4, 0.3, [](P& p, T&) { p.damping = 0; }},
      {"a hundred times the mass", 0.5, 0.06, 2e-3, 1, [](P& p, T&) { p.ring_mass *= 100, p.centre_mass *= 100; }},
      {"a hundredth of the centre's mass", 0.5, 0.06, 2e-3, 1, [](P& p, T&) { p.centre_mass /= 100; }},
      {"ten thousand times the damping", 0.5, 0.06, 2e-3, 0.3, [](P& p, T&) { p.damping *= 1e4; }},
      {"200 m/s at the start", 0, 0, 2e-3, 0.3, [](P&, T& t) { t.initial_speed = 200; }},
      {"pushed against the stop", 0, 0, 2e-3, 0.5, [](P&, T& t) { t.push = -150; }},
  };
  for (const Extreme& extreme : cases) EXPECT_EQ(run(extreme), "") << extreme.name;
}

/// The same with steps so long that the scheme itself decides: no answer, and why.
TEST(MotionExtremes, StepsThatFeedABarrierAreRefused) {
  using P = vehicle::VehicleParameters;
  using T = vehicle::Trial;
  const std::vector<Extreme> cases = {
      {"steps of 20 ms", 0.5, 0.06, 0.02, 2, [](P&, T&) {}},
      {"full thrust in one step", 1, 0.03, 2e-3, 2, [](P& p, T&) { p.time_constant_up = p.time_constant_down = 1e-6; }},
      {"no damping", 0.5, 0.06, 2e-3, 0.3, [](P& p, T&) { p.damping = 0; }},
  };
  for (const Extreme& extreme : cases) {
    EXPECT_NE(run(extreme).find("the scheme added or removed"), std::string::npos) << extreme.name;
  }
}

/// In the plane and as a solid: an answer, or a reason.
TEST(MotionExtremes, ANearlyIncompressibleArm) {
  vehicle::Vehicle vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  const vehicle::VehicleParameters parameters = vehicle::realise(vehicle, vehicle::armTableOf(vehicle));
  vehicle::Trial trial;
  trial.wings = false;
  trial.initial_thrust_fraction = 0.0;
  for (const int dimension : {2, 3}) {
    vehicle.material.poisson_ratio.value = 0.4999;
    AxisSettings settings;
    settings.dimension = dimension;
    settings.cell_size = 0.0025;
    if (dimension == 3) settings.kernel = scene::SceneKernel::LINEAR_REDUCED;
    try {
      const AxisVehicle soft(vehicle, parameters, trial, settings);
      StepperSettings steps;
      steps.largest_step = 2e-3;
      steps.relative_tolerance = 1e-6;
      Stepper stepper(soft.problem(), Scheme(SchemeKind::MIDPOINT), steps);
      MotionState state = soft.start(vehicle::Mode::FIXED_WING, 0);
      while (state.time < 0.05) {
        stepper.step(state, 0.05, [&](double, double) { return Eigen::VectorXd::Constant(1, 20.0); });
        ASSERT_TRUE(std::isfinite(soft.travel(state)) && std::isfinite(state.stored));
      }
      EXPECT_GT(soft.travel(state), 0.002) << dimension;
      EXPECT_LT(soft.travel(state), 0.08) << dimension;
    } catch (const common::Error& error) {
      const std::string reason = error.what();
      EXPECT_TRUE(reason.find("no equilibrium at") != std::string::npos ||
                  reason.find("failed at") != std::string::npos ||
                  reason.find("second equilibrium") != std::string::npos)
          << reason;
    }
  }
}

/// The centre strikes the upper stop at 5 m/s: it comes back with about its restitution, and no energy is made.
TEST(MotionExtremes, AStrikeOnTheStopAtFiveMetresASecond) {
  const vehicle::Vehicle vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  const vehicle::VehicleParameters parameters = vehicle::realise(vehicle, vehicle::armTableOf(vehicle));
  vehicle::Trial trial;
  trial.mount = vehicle::Mount::HELD;
  trial.wings = false;
  AxisSettings settings;
  settings.cell_size = 0.0025;
  const AxisVehicle soft(vehicle, parameters, trial, settings);
  StepperSettings steps;
  steps.largest_step = 2e-4;
  Stepper stepper(soft.problem(), Scheme(SchemeKind::MIDPOINT), steps);
  MotionState state = soft.start(vehicle::Mode::FIXED_WING, 0);
  state.v(state.v.size() - 1) = 5;  // the centre, upwards: u' = -5
  // The arm's clamp moves with the centre.
  state = stepper.start(state.z, Eigen::VectorXd::Zero(1),
                        soft.problem()->coordinates().linear().expandDirection(
                            soft.problem()->coordinates().linear().freePart(state.v), Eigen::VectorXd::Zero(1)));
  const ControlOf none = [](double, double) { return Eigen::VectorXd::Zero(1); };
  const double before = state.kinetic + state.stored;
  double least = 0, most = 0;
  while (state.time < 0.03) {
    stepper.step(state, 0.03, none);
    least = std::min(least, soft.travel(state));
    most = std::max(most, state.kinetic + state.stored);
  }
  EXPECT_LT(least, vehicle.limits.travel_min);
  EXPECT_GT(least, vehicle.limits.travel_min - 0.02);
  EXPECT_LT(most, 1.01 * before);
  EXPECT_LT(state.kinetic + state.stored, before);
}

}  // namespace
}  // namespace snapwing::motion
