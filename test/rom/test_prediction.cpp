#include <gtest/gtest.h>

#include <cmath>

#include "snapwing/common/error.h"
#include "snapwing/rom/lumped_model.h"
#include "snapwing/vehicle/vehicle.h"
#include "support/example_table.h"
#include "support/example_wing.h"
#include "support/paths.h"

namespace snapwing::rom {
namespace {

using vehicle::Mode;

class Prediction : public ::testing::Test {
 protected:
  Prediction()
      : vehicle_(vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml")),
        table_(snapwing::testing::exampleTable()),
        model_(LumpedModel::fromVehicle(vehicle_, table_, vehicle::realise(vehicle_, table_), {},
                                        snapwing::testing::exampleTableWing(vehicle_))) {
    trial_.mount = vehicle::Mount::BOOM;
  }
  SnapPrediction predict(Mode start, double throttle, double duration) const {
    return model_.predict(start, {throttle, duration}, vehicle_.radio, trial_);
  }
  vehicle::Vehicle vehicle_;
  vehicle::ForceTable table_;
  LumpedModel model_;
  vehicle::Trial trial_;
};

TEST_F(Prediction, SwitchesAndMarginAgreeOverAGridOfPulses) {
  int switched = 0, stayed = 0;
  for (const Mode start : {Mode::FIXED_WING, Mode::QUADROTOR}) {
    for (double throttle = 0.0; throttle <= 1.0; throttle += 0.125) {
      for (double duration = 0.0; duration <= 1.2; duration += 0.1) {
        const SnapPrediction p = predict(start, throttle, duration);
        ASSERT_TRUE(std::isfinite(p.energy_margin));
        EXPECT_LE(p.least_travel, p.peak_travel);
        if (p.snapped) {
          ++switched;
          EXPECT_EQ(p.end_mode, vehicle::otherMode(start));
          EXPECT_GE(p.energy_margin, 0.0);
          EXPECT_TRUE(std::isfinite(p.snap_time));
        } else {
          ++stayed;
          EXPECT_LE(p.energy_margin, 0.0) << throttle << " " << duration;
        }
      }
    }
  }
  EXPECT_GT(switched, 30);
  EXPECT_GT(stayed, 30);
}

TEST_F(Prediction, HoldOfThePulsesOwnLevelIsALongerPulse) {
  const SnapPrediction one = predict(Mode::FIXED_WING, 0.6, 0.16);
  const SnapPrediction two = model_.predict(Mode::FIXED_WING, {0.6, 0.1, 0.6, 0.06}, vehicle_.radio, trial_);
  EXPECT_EQ(one.end_mode, two.end_mode);
  EXPECT_NEAR(one.snap_time, two.snap_time, 1e-9);
  EXPECT_NEAR(one.peak_travel, two.peak_travel, 1e-9);
  EXPECT_NEAR(one.energy_margin, two.energy_margin, 1e-9);
}

TEST_F(Prediction, HoldThatOutlastsTheMotionIsAFinalThrust) {
  const double share = model_.thrustFraction(vehicle_.radio, 0.3);
  vehicle::Trial steady = trial_;
  steady.final_thrust_fraction = share;
  const SnapPrediction lasting = model_.predict(Mode::FIXED_WING, {0.6, 0.16}, vehicle_.radio, steady);
  const SnapPrediction held = model_.predict(Mode::FIXED_WING, {0.6, 0.16, 0.3, 10.0}, vehicle_.radio, steady);
  EXPECT_EQ(lasting.end_mode, held.end_mode);
  EXPECT_NEAR(lasting.peak_travel, held.peak_travel, 1e-9);
  EXPECT_NEAR(lasting.snap_time, held.snap_time, 1e-9);
  // What comes after a short hold is the trial's final thrust again.
  const SnapPrediction handed = model_.predict(Mode::FIXED_WING, {0.6, 0.16, 0.3, 0.5}, vehicle_.radio, steady);
  EXPECT_EQ(lasting.end_mode, handed.end_mode);
  EXPECT_NEAR(lasting.peak_travel, handed.peak_travel, 1e-9);
}

TEST_F(Prediction, HalfAHoldIsRefused) {
  EXPECT_THROW(model_.predict(Mode::FIXED_WING, {0.6, 0.16, 0.3, 0.0}, vehicle_.radio, trial_), common::Error);
  EXPECT_THROW(model_.predict(Mode::FIXED_WING, {0.6, 0.16, 0.0, 0.3}, vehicle_.radio, trial_), common::Error);
  EXPECT_THROW(model_.predict(Mode::FIXED_WING, {0.6, 0.16, 1.1, 0.3}, vehicle_.radio, trial_), common::Error);
  EXPECT_THROW(model_.predict(Mode::FIXED_WING, {0.6, 0.16, 0.3, NAN}, vehicle_.radio, trial_), common::Error);
}

TEST_F(Prediction, MarginVanishesOnBothSidesOfEveryThreshold) {
  // While the motors slow down the barrier moves with the load: near a threshold the body rides on it without turning.
  struct Case {
    Mode start;
    vehicle::Mount mount;
    double throttle, low, high;  // [s] the outcome differs between these lengths
    bool wings = false;
  };
  for (const Case& c : {Case{Mode::FIXED_WING, vehicle::Mount::BOOM, 0.58, 0.06, 0.12},
                        {Mode::FIXED_WING, vehicle::Mount::BOOM, 1.0, 0.01, 0.1},
                        {Mode::FIXED_WING, vehicle::Mount::BOOM, 0.85, 0.6, 0.8},
                        {Mode::FIXED_WING, vehicle::Mount::FREE, 0.7, 0.02, 0.1},
                        {Mode::QUADROTOR, vehicle::Mount::BOOM, 1.0, 0.4, 0.6},
                        {Mode::QUADROTOR, vehicle::Mount::FREE, 0.7, 0.9, 1.0},
                        {Mode::FIXED_WING, vehicle::Mount::FREE, 0.7, 0.02, 0.15, true},
                        {Mode::FIXED_WING, vehicle::Mount::FREE, 1.0, 0.02, 0.15, true},
                        {Mode::QUADROTOR, vehicle::Mount::FREE, 1.0, 0.3, 0.7, true}}) {
    trial_.mount = c.mount;
    trial_.wings = c.wings;
    double low = c.low, high = c.high;
    const bool at_low = predict(c.start, c.throttle, low).snapped;
    ASSERT_NE(at_low, predict(c.start, c.throttle, high).snapped) << c.throttle;
    for (int i = 0; i < 30; ++i) {
      const double middle = 0.5 * (low + high);
      (predict(c.start, c.throttle, middle).snapped == at_low ? low : high) = middle;
    }
    EXPECT_NEAR(predict(c.start, c.throttle, low).energy_margin, 0.0, 1e-3) << c.throttle << " " << low;
    EXPECT_NEAR(predict(c.start, c.throttle, high).energy_margin, 0.0, 1e-3) << c.throttle << " " << high;
  }
}

TEST_F(Prediction, TheTwoPulsesOfThePaperSwitchTheShippedVehicle) {
  const SnapPrediction up = predict(Mode::FIXED_WING, 0.65, 0.2);
  EXPECT_TRUE(up.snapped);
  EXPECT_GT(up.energy_margin, 0.1);
  const SnapPrediction back = predict(Mode::QUADROTOR, 1.0, 0.85);
  EXPECT_TRUE(back.snapped);
  EXPECT_GT(back.energy_margin, 0.1);
}

TEST_F(Prediction, NothingHappensWithoutAPulse) {
  for (const Mode start : {Mode::FIXED_WING, Mode::QUADROTOR}) {
    for (const auto& [throttle, duration] : {std::pair{0.0, 0.5}, std::pair{1.0, 0.0}}) {
      const SnapPrediction p = predict(start, throttle, duration);
      EXPECT_EQ(p.end_mode, start);
      EXPECT_FALSE(p.snapped);
      EXPECT_TRUE(std::isnan(p.snap_time));
      EXPECT_LT(p.energy_margin, -0.5);
      EXPECT_LT(p.peak_travel - p.least_travel, 2e-3);
    }
  }
}

TEST_F(Prediction, SettledEndStaysWhereItIs) {
  // The early end of the integration must not hide a later change: watch five seconds more by settling never.
  LumpedSettings patient;
  patient.settled_share = 1e-9;
  const LumpedModel slow = LumpedModel::fromVehicle(vehicle_, table_, model_.parameters(), patient);
  trial_.horizon = 5.0;
  for (const double throttle : {0.4, 0.45, 0.5, 0.65, 0.8, 1.0}) {
    for (const double duration : {0.1, 0.3, 0.6, 0.9, 1.2}) {
      for (const Mode start : {Mode::FIXED_WING, Mode::QUADROTOR}) {
        const double barrier = model_.potential().equilibria().barrier;
        const SnapPrediction quick = predict(start, throttle, duration);
        const SnapPrediction full = slow.predict(start, {throttle, duration}, vehicle_.radio, trial_);
        EXPECT_EQ(quick.end_mode == Mode::QUADROTOR, full.end_travel > barrier) << throttle << " " << duration;
      }
    }
  }
}

TEST_F(Prediction, StepHardlyMatters) {
  LumpedSettings fine;
  fine.step = 5e-5;
  const LumpedModel exact = LumpedModel::fromVehicle(vehicle_, table_, model_.parameters(), fine);
  for (const auto& [throttle, duration] : {std::pair{0.65, 0.2}, std::pair{1.0, 0.85}}) {
    const Mode start = throttle < 1 ? Mode::FIXED_WING : Mode::QUADROTOR;
    const SnapPrediction a = predict(start, throttle, duration);
    const SnapPrediction b = exact.predict(start, {throttle, duration}, vehicle_.radio, trial_);
    EXPECT_NEAR(a.peak_travel, b.peak_travel, 2e-5);
    EXPECT_NEAR(a.snap_time, b.snap_time, 1e-4);
    EXPECT_NEAR(a.energy_margin, b.energy_margin, 5e-3);
  }
}

TEST_F(Prediction, BoomOnlyMattersOnTheBoom) {
  vehicle::VehicleParameters p = model_.parameters();
  p.boom_mass *= 2;
  p.boom_drag *= 2;
  p.boom_friction *= 2;
  const LumpedModel heavy =
      LumpedModel::fromVehicle(vehicle_, table_, p, {}, snapwing::testing::exampleTableWing(vehicle_));
  EXPECT_NE(heavy.predict(Mode::FIXED_WING, 0.4, 0.2, trial_).peak_travel,
            model_.predict(Mode::FIXED_WING, 0.4, 0.2, trial_).peak_travel);
  trial_.mount = vehicle::Mount::FREE;
  EXPECT_EQ(heavy.predict(Mode::FIXED_WING, 0.4, 0.2, trial_).peak_travel,
            model_.predict(Mode::FIXED_WING, 0.4, 0.2, trial_).peak_travel);
}

TEST_F(Prediction, LatencyDelaysAndNothingElse) {
  vehicle::VehicleParameters p = model_.parameters();
  p.latency = 0.0;
  vehicle::Trial rest;  // free and level, so that waiting changes nothing but the idle thrust's drift
  rest.initial_thrust_fraction = 0.0;
  const LumpedModel early = LumpedModel::fromVehicle(vehicle_, table_, p);
  p.latency = 0.2;
  const LumpedModel late = LumpedModel::fromVehicle(vehicle_, table_, p);
  const SnapPrediction a = early.predict(Mode::FIXED_WING, 0.5, 0.2, rest);
  const SnapPrediction b = late.predict(Mode::FIXED_WING, 0.5, 0.2, rest);
  EXPECT_NEAR(b.snap_time - a.snap_time, 0.2, 1e-9);
  EXPECT_NEAR(b.peak_travel, a.peak_travel, 1e-12);
}

TEST_F(Prediction, TellsWhenTheTableIsLeft) {
  vehicle::ForceTable cut = table_;
  while (cut.travel.back() > 0.060) {
    cut.travel.pop_back(), cut.force.pop_back(), cut.stiffness.pop_back(), cut.energy.pop_back();
    cut.rotation.pop_back(), cut.min_det_f.pop_back(), cut.stable.pop_back(), cut.iterations.pop_back();
    cut.kinetic_mass.pop_back(), cut.coupled_mass.pop_back();
  }
  const LumpedModel model = LumpedModel::fromVehicle(vehicle_, cut, model_.parameters());
  EXPECT_TRUE(model.predict(Mode::QUADROTOR, 1.0, 0.3, trial_).out_of_table);
  EXPECT_FALSE(model_.predict(Mode::QUADROTOR, 0.3, 0.3, trial_).out_of_table);
}

TEST_F(Prediction, ObserverSeesTheMotionAndMayStopIt) {
  double last = -1;
  int seen = 0;
  model_.predict(Mode::FIXED_WING, 0.4, 0.2, trial_, [&](const LumpedState& s) {
    EXPECT_GT(s.time, last);
    last = s.time;
    return ++seen < 50;
  });
  EXPECT_EQ(seen, 50);
}

TEST_F(Prediction, SameInputSameBits) {
  const SnapPrediction a = predict(Mode::QUADROTOR, 0.93, 0.77), b = predict(Mode::QUADROTOR, 0.93, 0.77);
  EXPECT_EQ(a.energy_margin, b.energy_margin);
  EXPECT_EQ(a.end_travel, b.end_travel);
}

TEST_F(Prediction, RefusesNonsense) {
  EXPECT_THROW(predict(Mode::UNKNOWN, 0.5, 0.2), common::Error);
  EXPECT_THROW(predict(Mode::FIXED_WING, NAN, 0.2), common::Error);
  EXPECT_THROW(predict(Mode::FIXED_WING, 1.2, 0.2), common::Error);
  EXPECT_THROW(predict(Mode::FIXED_WING, 0.5, -0.1), common::Error);
  EXPECT_THROW(predict(Mode::FIXED_WING, 0.5, NAN), common::Error);
  trial_.gravity = NAN;
  EXPECT_THROW(predict(Mode::FIXED_WING, 0.5, 0.2), common::Error);
  trial_ = vehicle::Trial{};
  trial_.mount = vehicle::Mount::HELD;
  trial_.initial_speed = 1.0;
  EXPECT_THROW(predict(Mode::FIXED_WING, 0.5, 0.2), common::Error);
  EXPECT_THROW(vehicle::mountFromName("table"), common::Error);
}

}  // namespace
}  // namespace snapwing::rom
