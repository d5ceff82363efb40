// The plant and the reduced model share no code but the parameters: given the same ones, they must agree.
#include <gtest/gtest.h>

#include <cmath>

#include "snapwing/common/error.h"
#include "snapwing/rom/lumped_model.h"
#include "snapwing/standin/plant.h"
#include "snapwing/vehicle/pulse.h"
#include "support/example_table.h"
#include "support/example_wing.h"
#include "support/paths.h"

namespace snapwing::standin {
namespace {

struct Motion {
  double peak = -INFINITY, end = 0, speed = 0;
};

/// @param before  motor output before the pulse
Motion runPlant(const vehicle::Vehicle& vehicle, Plant plant, vehicle::Mode start, double before,
                const vehicle::Pulse& pulse, double end_time) {
  const vehicle::VehicleParameters& p = plant.parameters();
  plant.reset(start);
  const double idle = vehicle::motorOutput(vehicle.radio, 0.0),
               high = vehicle::motorOutput(vehicle.radio, pulse.throttle);
  // The reduced model starts at steady idle thrust in the loaded equilibrium; so does the plant after some time in the
  // hand. Both then wait for the latency.
  plant.grab();
  plant.setMotorOutputs({before, before, before, before});
  plant.advanceTo(3.0);
  plant.release();
  plant.advanceTo(3.0 + p.latency);
  plant.setMotorOutputs({high, high, high, high});
  Motion run;
  const auto follow = [&](double until) {
    while (plant.state().time < until) {
      plant.advanceTo(std::min(until, plant.state().time + 1e-3));
      run.peak = std::max(run.peak, plant.state().travel());
    }
  };
  follow(3.0 + p.latency + pulse.duration);
  plant.setMotorOutputs({idle, idle, idle, idle});
  follow(3.0 + end_time);
  run.end = plant.state().travel();
  run.speed = plant.state().ring_speed;
  return run;
}

struct Case {
  vehicle::Mode start;
  vehicle::Pulse pulse;
};

rom::SnapPrediction predict(const rom::LumpedModel& model, const vehicle::Vehicle& vehicle, const Case& c,
                            const vehicle::Trial& trial, rom::LumpedState* last) {
  return model.predict(c.start, c.pulse, vehicle.radio, trial, [&](const rom::LumpedState& s) {
    *last = s;
    return true;
  });
}

TEST(PlantAgainstRom, SameParametersSameMotion) {
  const vehicle::Vehicle vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  const vehicle::ForceTable table = snapwing::testing::exampleTableWithMass();
  vehicle::Trial trial;
  trial.mount = vehicle::Mount::BOOM;
  const Case cases[] = {{vehicle::Mode::FIXED_WING, {0.7, 0.16}},
                        {vehicle::Mode::FIXED_WING, {0.4, 0.20}},
                        {vehicle::Mode::QUADROTOR, {1.0, 0.95}},
                        {vehicle::Mode::QUADROTOR, {0.8, 0.40}}};
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const vehicle::VehicleParameters p = drawParameters(vehicle, table, seed);
    const rom::LumpedModel model = rom::LumpedModel::fromVehicle(vehicle, table, p);
    for (const auto& c : cases) {
      rom::LumpedState last;
      const rom::SnapPrediction predicted = predict(model, vehicle, c, trial, &last);
      const double idle = vehicle::motorOutput(vehicle.radio, 0.0);
      const Motion run = runPlant(vehicle, Plant(vehicle, table, p), c.start, idle, c.pulse, last.time);
      // Start (held or drifting at idle), friction's step and interpolation differ: measured below 0.1 mm.
      EXPECT_NEAR(run.peak, predicted.peak_travel, 1.5e-4) << "seed " << seed << " throttle " << c.pulse.throttle;
      EXPECT_NEAR(run.end, last.travel, 5e-4);
      EXPECT_NEAR(run.speed, last.ring_speed, 0.02);
    }
  }
}

TEST(PlantAgainstRom, SameParametersSameMotionWithWings) {
  const vehicle::Vehicle vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  const vehicle::ForceTable table = snapwing::testing::exampleTableWithMass();
  const std::optional<vehicle::WingTable> wing = snapwing::testing::exampleTableWing(vehicle);
  ASSERT_TRUE(wing);
  vehicle::Trial trial;  // free: wings are on
  // From rest: the heavier motion would still swing when the pulse comes if the hand let go under idle thrust.
  trial.initial_thrust_fraction = 0.0;
  PlantSettings settings;
  settings.mount = vehicle::Mount::FREE;
  const Case cases[] = {{vehicle::Mode::FIXED_WING, {0.7, 0.21}},
                        {vehicle::Mode::FIXED_WING, {0.45, 0.20}},
                        {vehicle::Mode::QUADROTOR, {1.0, 0.95}},
                        {vehicle::Mode::QUADROTOR, {0.8, 0.40}}};
  int switched = 0, compared = 0;
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    vehicle::VehicleParameters p = drawParameters(vehicle, table, seed);
    if (seed % 2 == 1) p.wing_friction = 0;  // its step is half as wide in the plant: seen where things creep
    const rom::LumpedModel model = rom::LumpedModel::fromVehicle(vehicle, table, p, {}, wing);
    for (const auto& c : cases) {
      rom::LumpedState last;
      const rom::SnapPrediction predicted = predict(model, vehicle, c, trial, &last);
      const Motion run = runPlant(vehicle, Plant(vehicle, table, p, settings, wing), c.start, 0.0, c.pulse, last.time);
      const double close = p.wing_friction > 0 ? 4e-4 : 1.5e-4;
      EXPECT_NEAR(run.peak, predicted.peak_travel, close) << "seed " << seed << " throttle " << c.pulse.throttle;
      if (predicted.least_travel > vehicle.limits.travel_min) {  // else the plant meets its stop, which the model lacks
        EXPECT_NEAR(run.end, last.travel, 5e-4);
        EXPECT_NEAR(run.speed, last.ring_speed, 0.02);
        ++compared;
      }
      switched += predicted.snapped;
    }
  }
  EXPECT_GE(switched, 8);
  EXPECT_GE(compared, 12);
}

TEST(PlantAgainstRom, SamePushSameMotion) {
  const vehicle::Vehicle vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  const vehicle::ForceTable table = snapwing::testing::exampleTableWithMass();
  const std::optional<vehicle::WingTable> wing = snapwing::testing::exampleTableWing(vehicle);
  vehicle::VehicleParameters p = drawParameters(vehicle, table, 5);
  p.wing_friction = 0;  // its step differs
  PlantSettings settings;
  settings.mount = vehicle::Mount::FREE;
  for (const bool wings : {false, true}) {
    settings.wings = wings;
    Plant plant(vehicle, table, p, settings, wing);
    plant.reset(vehicle::Mode::QUADROTOR);
    const rom::LumpedModel model = rom::LumpedModel::fromVehicle(vehicle, table, p, {}, wing);
    vehicle::Trial trial;
    trial.wings = wings;
    trial.initial_thrust_fraction = 0.0;
    rom::LumpedState state = model.startState(vehicle::Mode::QUADROTOR, trial);
    for (const double push : {6.0, -2.0, 0.0}) {
      plant.push(push);
      trial.push = push;
      for (int i = 0; i < 200; ++i) {
        state = model.step(state, 0.0, 5e-4, trial);
        plant.advanceTo(plant.state().time + 5e-4);
        ASSERT_NEAR(plant.state().travel(), state.travel, 1.5e-4) << "push " << push << " wings " << wings;
        ASSERT_NEAR(plant.centreSpecificForce(), model.centreSpecificForce(state, trial), 0.5);
      }
      EXPECT_NEAR(plant.state().ring_speed, state.ring_speed, 5e-3);
    }
    EXPECT_GT(std::abs(plant.state().ring_speed), 0.1);
    EXPECT_THROW(plant.push(NAN), common::Error);
  }
}

}  // namespace
}  // namespace snapwing::standin
