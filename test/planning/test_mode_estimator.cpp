#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "snapwing/common/error.h"
#include "snapwing/common/pulse.h"
#include "snapwing/common/table_origin.h"
#include "snapwing/dynamics/plant.h"
#include "snapwing/planning/mode_estimator.h"
#include "support/example_table.h"
#include "support/paths.h"

namespace snapwing::planning {
namespace {

using common::Mode;

class EstimatorTest : public ::testing::Test {
 protected:
  EstimatorTest()
      : vehicle_(common::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml")),
        table_(snapwing::testing::exampleTable()),
        idle_(common::motorOutput(vehicle_.radio, 0.0)) {}

  /// Runs the plant and feeds the estimator with a noisy, biased accelerometer at 200 Hz.
  void run(dynamics::Plant& plant, ModeEstimator& estimator, double output, double length) {
    std::normal_distribution<double> noise(0.1, 0.3);
    plant.setMotorOutputs({output, output, output, output});
    estimator.motorOutput(time_, output);
    for (const double end = time_ + length; time_ < end - 1e-9;) {
      time_ += 0.005;
      plant.advanceTo(time_);
      estimator.accelerometer(time_, plant.centreSpecificForce() + noise(random_));
    }
  }

  static double probabilityOf(Mode mode, const ModeEstimate& e) {
    return mode == Mode::FIXED_WING ? e.probability_fixed_wing : e.probability_quadrotor;
  }

  common::Vehicle vehicle_;
  common::ForceTable table_;
  double idle_;
  double time_ = 0;
  std::mt19937 random_{7};
};

TEST_F(EstimatorTest, FollowsBothSwitchesOfVehiclesWithOtherParameters) {
  for (const Mode told : {Mode::FIXED_WING, Mode::UNKNOWN}) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      time_ = 0;
      dynamics::Plant plant(vehicle_, table_, dynamics::drawParameters(vehicle_, table_, seed));
      plant.reset(Mode::FIXED_WING);
      ModeEstimator estimator(vehicle_, table_);
      estimator.reset(0.0, told);
      run(plant, estimator, idle_, 0.3);
      run(plant, estimator, common::motorOutput(vehicle_.radio, 0.7), 0.17);
      run(plant, estimator, idle_, 0.8);
      ASSERT_EQ(plant.mode(), Mode::QUADROTOR);
      EXPECT_GT(estimator.estimate().probability_quadrotor, 0.95) << seed;
      EXPECT_EQ(estimator.estimate().mode, Mode::QUADROTOR);
      EXPECT_NEAR(estimator.estimate().travel, plant.state().travel(), 0.003);
      run(plant, estimator, 1.0, 0.95);
      run(plant, estimator, idle_, 1.0);
      ASSERT_EQ(plant.mode(), Mode::FIXED_WING);
      EXPECT_GT(estimator.estimate().probability_fixed_wing, 0.95) << seed;
      EXPECT_NEAR(estimator.estimate().travel, plant.state().travel(), 0.003);
    }
  }
}

TEST_F(EstimatorTest, FollowsSwitchesWithWings) {
  const std::optional<common::WingTable> wing = common::wingTableOf(vehicle_, common::armTableOf(vehicle_));
  dynamics::PlantSettings flight;
  flight.mount = dynamics::PlantMount::FREE;
  EstimatorSettings settings;
  settings.mount = rom::Mount::FREE;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    time_ = 0;
    dynamics::Plant plant(vehicle_, table_, dynamics::drawParameters(vehicle_, table_, seed), flight, wing);
    plant.reset(Mode::FIXED_WING);
    ModeEstimator estimator(vehicle_, table_, settings, wing);
    estimator.reset(0.0, Mode::FIXED_WING);
    run(plant, estimator, idle_, 0.3);
    run(plant, estimator, common::motorOutput(vehicle_.radio, 0.7), 0.22);
    run(plant, estimator, idle_, 0.8);
    ASSERT_EQ(plant.mode(), Mode::QUADROTOR);
    EXPECT_EQ(estimator.estimate().mode, Mode::QUADROTOR) << seed;
    EXPECT_NEAR(estimator.estimate().travel, plant.state().travel(), 0.003);
    run(plant, estimator, 1.0, 0.97);
    run(plant, estimator, idle_, 1.0);
    ASSERT_EQ(plant.mode(), Mode::FIXED_WING);
    EXPECT_EQ(estimator.estimate().mode, Mode::FIXED_WING) << seed;
    EXPECT_NEAR(estimator.estimate().travel, plant.state().travel(), 0.003);
  }
}

TEST_F(EstimatorTest, SeesASwitchThatDidNotHappen) {
  // The motors are told full pulses, but the vehicle's own parameters make it stay: a weak pulse, seen to fail.
  dynamics::Plant plant(vehicle_, table_, dynamics::drawParameters(vehicle_, table_, 3));
  plant.reset(Mode::FIXED_WING);
  ModeEstimator estimator(vehicle_, table_);
  estimator.reset(0.0, Mode::FIXED_WING);
  run(plant, estimator, idle_, 0.2);
  run(plant, estimator, common::motorOutput(vehicle_.radio, 0.38), 0.3);
  run(plant, estimator, idle_, 0.8);
  ASSERT_EQ(plant.mode(), Mode::FIXED_WING);
  EXPECT_GT(estimator.estimate().probability_fixed_wing, 0.95);
}

TEST_F(EstimatorTest, KnowsNothingFromRestAlone) {
  // At rest both modes read the same: the estimate must not talk itself into one of them.
  for (const Mode truth : {Mode::FIXED_WING, Mode::QUADROTOR}) {
    time_ = 0;
    dynamics::Plant plant(vehicle_, table_, common::realise(vehicle_, table_));
    plant.reset(truth);
    plant.grab();
    ModeEstimator estimator(vehicle_, table_);
    estimator.reset(0.0, Mode::UNKNOWN);
    run(plant, estimator, 0.0, 1.0);
    EXPECT_EQ(estimator.estimate().mode, Mode::UNKNOWN);
    EXPECT_GT(estimator.estimate().probability_fixed_wing, 0.1);
    EXPECT_LT(estimator.estimate().probability_fixed_wing, 0.9);
  }
}

TEST_F(EstimatorTest, ThrustThatNeverCameIsNotASwitch) {
  // The frames say pulse, the link is dead: with outputs read back nothing moves and the estimate stays.
  dynamics::Plant plant(vehicle_, table_, common::realise(vehicle_, table_));
  plant.reset(Mode::QUADROTOR);
  ModeEstimator estimator(vehicle_, table_);
  estimator.reset(0.0, Mode::QUADROTOR);
  run(plant, estimator, idle_, 2.0);
  EXPECT_GT(estimator.estimate().probability_quadrotor, 0.95);
}

TEST_F(EstimatorTest, CommandedPulseServesWithoutReadBack) {
  dynamics::Plant plant(vehicle_, table_, dynamics::drawParameters(vehicle_, table_, 2));
  plant.reset(Mode::FIXED_WING);
  ModeEstimator estimator(vehicle_, table_);
  estimator.reset(0.0, Mode::FIXED_WING);
  const common::Pulse pulse{0.7, 0.17};
  const double latency = plant.parameters().latency;
  estimator.commandedPulse(0.1, pulse);
  for (double t = 0.005; t < 1.5; t += 0.005) {
    const bool on = t >= 0.1 + latency && t < 0.1 + latency + pulse.duration;
    const double s = on ? common::motorOutput(vehicle_.radio, pulse.throttle) : 0.0;
    plant.setMotorOutputs({s, s, s, s});
    plant.advanceTo(t);
    estimator.accelerometer(t, plant.centreSpecificForce());
  }
  ASSERT_EQ(plant.mode(), Mode::QUADROTOR);
  EXPECT_GT(estimator.estimate().probability_quadrotor, 0.95);
}

TEST_F(EstimatorTest, SameInputSameBitsAndBadReadingsAreIgnored) {
  EstimatorSettings settings;
  settings.particles = 50;
  ModeEstimator a(vehicle_, table_, settings), b(vehicle_, table_, settings);
  a.reset(0.0, Mode::FIXED_WING);
  b.reset(0.0, Mode::FIXED_WING);
  for (double t = 0.005; t < 0.5; t += 0.005) {
    a.motorOutput(t, 0.5);
    b.motorOutput(t, 0.5);
    a.accelerometer(t, 8.0);
    b.accelerometer(t, 8.0);
    b.accelerometer(t, NAN);
    b.motorOutput(t, NAN);
    b.motorOutput(t - 1.0, 1.0);
    b.accelerometer(t - 1.0, 0.0);
  }
  EXPECT_EQ(a.estimate().travel, b.estimate().travel);
  EXPECT_EQ(a.estimate().probability_quadrotor, b.estimate().probability_quadrotor);
}

TEST_F(EstimatorTest, RefusesBadSettings) {
  EstimatorSettings settings;
  settings.particles = 3;
  EXPECT_THROW(ModeEstimator(vehicle_, table_, settings), common::Error);
  settings = {};
  settings.accelerometer_noise = 0;
  EXPECT_THROW(ModeEstimator(vehicle_, table_, settings), common::Error);
}

}  // namespace
}  // namespace snapwing::planning
