// A hand that holds the ring: its motion, what the centre makes of it, and files that say too little.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "snapwing/common/error.h"
#include "snapwing/motion/axis_vehicle.h"
#include "snapwing/motion/trial_file.h"
#include "snapwing/vehicle/table_origin.h"
#include "support/own_folder.h"
#include "support/paths.h"

namespace snapwing::motion {
namespace {

TEST(HandMotion, ItsNoiseHasTheStrengthThatIsAskedAndIsOneMotion) {
  HandSettings settings;
  settings.noise = 2, settings.low = 3, settings.high = 10, settings.seed = 7;
  settings.swing = 0.01, settings.swing_frequency = 1.5;
  const HandMotion hand(settings), same(settings);
  settings.swing = 0;
  const HandMotion noise(settings);
  settings.seed = 8;
  const HandMotion other(settings);
  const double h = 1e-3;
  double squared = 0, apart = 0;
  const int count = 60000;
  for (int k = 0; k < count; ++k) {
    const double t = h * k;
    squared += std::pow(noise.acceleration(t), 2) / count;
    apart += std::pow(noise.acceleration(t) - other.acceleration(t), 2) / count;
    EXPECT_EQ(hand.position(t), same.position(t));
    if (k % 1000 != 0) continue;
    EXPECT_NEAR(hand.speed(t), (hand.position(t + 1e-6) - hand.position(t - 1e-6)) / 2e-6, 1e-6);
    EXPECT_NEAR(hand.acceleration(t), (hand.speed(t + 1e-6) - hand.speed(t - 1e-6)) / 2e-6, 1e-4);
    EXPECT_NEAR(hand.meanAcceleration(t, h), hand.acceleration(t + h / 2), 0.05);
  }
  EXPECT_NEAR(std::sqrt(squared), 2, 0.1);
  EXPECT_NEAR(std::sqrt(apart), 2 * std::sqrt(2.0), 0.3) << "another seed is another motion";
  EXPECT_EQ(hand.position(0), 0);
}

/// A small swing: amplitude of an oscillator on a base that moves, with the arms' inertia on the static path.
TEST(Hand, ASwingMovesTheCentreAsABaseMovesAnOscillator) {
  const vehicle::Vehicle vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  vehicle::VehicleParameters p = vehicle::realise(vehicle, vehicle::armTableOf(vehicle));
  p.centre_drag = 0;
  vehicle::Trial trial;
  trial.mount = vehicle::Mount::HELD;
  trial.wings = false;
  AxisSettings settings;
  settings.cell_size = 0.0025;
  settings.hand.emplace();
  settings.hand->swing = 2e-5;
  settings.hand->swing_frequency = 2;
  const AxisVehicle soft(vehicle, p, trial, settings);
  const vehicle::ForceTable arm = soft.staticTable();
  const double n = arm.arm_count, rate = 2 * std::acos(-1.0) * 2;
  const double mass = p.centre_mass + n * arm.kinetic_mass[0], load = p.centre_mass - n * arm.coupled_mass[0],
               stiffness = n * arm.stiffness[0];
  const double wanted = load * 2e-5 * rate * rate / std::hypot(stiffness - mass * rate * rate, p.damping * rate);
  StepperSettings steps;
  steps.largest_step = 2e-3;
  Stepper stepper(soft.problem(), Scheme(SchemeKind::MIDPOINT), steps);
  MotionState state = soft.start(vehicle::Mode::FIXED_WING, 0);
  double most = 0, least = 0;
  while (state.time < 2.8) {
    stepper.step(state, 2.8, [&](double from, double h) { return soft.controls(from, h, 0); });
    if (state.time < 2.25) continue;
    most = std::max(most, soft.travel(state)), least = std::min(least, soft.travel(state));
  }
  EXPECT_NEAR(0.5 * (most - least), wanted, 0.02 * wanted);
  EXPECT_EQ(soft.sample(state).ring_position, HandMotion(*settings.hand).position(state.time));
  trial.mount = vehicle::Mount::FREE;
  EXPECT_THROW(AxisVehicle(vehicle, p, trial, settings), common::Error);
}

TEST(TrialFile, HandAndSpaceAreReadAndRefusedByKeyValueAndRange) {
  const std::string head = "trial: t\nvehicle: " + test::sourceDir() +
                           "/config/vehicles/arris_x220.yaml\nstart: F\npulse: {thrust: 0.5, duration: 0.06}\n";
  const auto load = [&](const std::string& text) {
    const std::string path = test::ownFolder() + "t.yaml";
    std::ofstream(path) << head << text;
    return loadTrial(path);
  };
  const TrialFile hand = load("mount: held\nhand: {noise: 0.5, seed: 3, swing: 0.01}\n");
  ASSERT_TRUE(hand.axis.hand.has_value());
  EXPECT_EQ(hand.axis.hand->seed, 3u);
  const TrialFile six = load(
      "mount: free\nrung: volumetric\nfreedom: six\ngravity_across: 9.81\n"
      "propellers: {scale: [1, 1, 1, 0.9], moment_per_thrust: 0.012}\n");
  EXPECT_TRUE(six.six);
  EXPECT_EQ(six.space.rotor_scale.back(), 0.9);
  EXPECT_EQ(six.trial.wings, false);
  const std::vector<std::pair<std::string, std::string>> bad = {
      {"mount: held\nhand: {noise: 0.5}\n", "hand.seed"},
      {"mount: held\nhand: {noise: -1, seed: 1}\n", "hand.noise"},
      {"mount: held\nhand: {noise: 1, seed: 1, low: 5, high: 4}\n", "hand.high"},
      {"mount: free\nhand: {swing: 0.01}\n", "hand"},
      {"mount: held\nrung: lumped\nhand: {swing: 0.01}\n", "hand"},
      {"mount: free\nfreedom: six\n", "freedom"},
      {"mount: free\nfreedom: seven\n", "freedom"},
      {"mount: free\nrung: volumetric\nfreedom: six\nwings: on\nsolid: {wings_follow: travel}\n", "wings_follow"},
      {"mount: free\nrung: volumetric\nfreedom: six\nsolid: {damping: rayleigh}\n", "damping"},
      {"mount: free\nrung: volumetric\nfreedom: six\npropellers: {scale: [1, 3]}\n", "propellers.scale"},
      {"mount: free\nrung: volumetric\nfreedom: six\npropellers: {sag: 2}\n", "propellers.sag"},
      {"mount: free\npropellers: {sag: 0.1}\n", "propellers"},
  };
  for (const auto& [text, key] : bad) {
    try {
      load(text);
      ADD_FAILURE() << text;
    } catch (const common::Error& error) {
      EXPECT_NE(std::string(error.what()).find(key), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("allowed"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace snapwing::motion
