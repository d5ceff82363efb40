// Many vehicles side by side against the lumped model, one at a time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "snapwing/common/error.h"
#include "snapwing/rom/ensemble.h"
#include "snapwing/vehicle/table_origin.h"
#include "support/paths.h"

namespace {

using namespace snapwing;

struct Shipped {
  vehicle::Vehicle vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  vehicle::ForceTable table = vehicle::armTableOf(vehicle);
  rom::VehicleCurves curves{table, vehicle::wingTableOf(vehicle, table)};
  std::vector<vehicle::VehicleParameters> drawn;

  explicit Shipped(int count) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> within(-1, 1);
    for (int i = 0; i < count; ++i) {
      std::vector<double> point(vehicle::uncertainNames().size());
      for (double& x : point) x = within(random);
      drawn.push_back(vehicle::realise(vehicle, table, point));
    }
  }
  rom::Ensemble ensemble(double step = 2e-3, rom::Vectors vectors = rom::Vectors::WIDEST) const {
    rom::EnsembleSettings settings;
    settings.model.step = step;
    settings.vectors = vectors;
    rom::Ensemble e(curves, vehicle.radio, settings);
    for (const auto& p : drawn) e.add(p);
    return e;
  }
};

struct Case {
  const char* name;
  vehicle::Mode start;
  vehicle::Mount mount;
  bool wings;
  double gravity, throttle, duration;
  double hold_throttle = 0, hold_duration = 0;
  vehicle::Pulse pulse() const { return {throttle, duration, hold_throttle, hold_duration}; }
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class EnsembleAgainstLumped : public testing::TestWithParam<Case> {};

TEST_P(EnsembleAgainstLumped, SaysTheSame) {
  const Case c = GetParam();
  const Shipped s(24);
  vehicle::Trial trial;
  trial.mount = c.mount;
  trial.wings = c.wings;
  trial.gravity = c.gravity;
  const std::vector<double> durations(s.drawn.size(), c.duration);
  const rom::Ensemble ensemble = s.ensemble();
  const auto told = ensemble.predict(c.start, c.pulse(), durations, trial, 0, ensemble.size());
  rom::LumpedSettings fine;
  fine.step = 2.5e-4;
  double squares = 0;
  for (std::size_t i = 0; i < s.drawn.size(); ++i) {
    const rom::LumpedModel model = s.curves.model(s.vehicle.radio, s.drawn[i], fine);
    const rom::SnapPrediction truth = model.predict(c.start, c.pulse(), s.vehicle.radio, trial);
    if (std::abs(truth.energy_margin) > 0.02) {
      EXPECT_EQ(told[i].snapped, truth.snapped) << i;
    }
    EXPECT_NEAR(told[i].peak_travel, truth.peak_travel, 2e-4) << i;
    EXPECT_NEAR(told[i].energy_margin, truth.energy_margin, 0.03) << i;
    squares += std::pow(told[i].energy_margin - truth.energy_margin, 2);
  }
  EXPECT_LT(std::sqrt(squares / s.drawn.size()), 6e-3);
}

const auto F = vehicle::Mode::FIXED_WING, Q = vehicle::Mode::QUADROTOR;
INSTANTIATE_TEST_SUITE_P(Trials, EnsembleAgainstLumped,
                         testing::Values(Case{"boom_F", F, vehicle::Mount::BOOM, false, 0, 0.61, 0.16},
                                         Case{"boom_Q", Q, vehicle::Mount::BOOM, false, 0, 1.0, 0.60},
                                         Case{"too_short", Q, vehicle::Mount::BOOM, false, 0, 1.0, 0.30},
                                         Case{"held_upright", F, vehicle::Mount::HELD, false, 9.81, 0.61, 0.16},
                                         Case{"free_F", F, vehicle::Mount::FREE, false, 0, 0.61, 0.16},
                                         Case{"free_Q", Q, vehicle::Mount::FREE, false, 0, 1.0, 0.60},
                                         Case{"climbing", F, vehicle::Mount::FREE, false, 9.81, 0.61, 0.16},
                                         Case{"wings_F", F, vehicle::Mount::FREE, true, 0, 0.61, 0.20},
                                         Case{"wings_Q", Q, vehicle::Mount::FREE, true, 0, 1.0, 0.75},
                                         Case{"hold_F", F, vehicle::Mount::FREE, false, 0, 0.61, 0.16, 0.33, 0.9},
                                         Case{"hold_wings_F", F, vehicle::Mount::FREE, true, 0, 0.61, 0.16, 0.33, 1.3}),
                         [](const auto& tried) { return std::string(tried.param.name); });

class EnsembleAtItsOwnStep : public testing::TestWithParam<Case> {};

TEST_P(EnsembleAtItsOwnStep, HasMarginsWithinAThousandth) {
  // Not only few vehicles' error counts, as of a worst one, but all vehicles' together.
  const Case c = GetParam();
  const Shipped s(64);
  vehicle::Trial trial;
  trial.mount = c.mount;
  trial.wings = c.wings;
  std::vector<double> durations;
  for (int i = 0; i < 64; ++i) durations.push_back(c.duration + 0.02 * (i / 32.0 - 1));
  const rom::Ensemble ensemble = s.ensemble(rom::EnsembleSettings().model.step);
  const auto told = ensemble.predict(c.start, c.pulse(), durations, trial, 0, ensemble.size());
  rom::LumpedSettings fine;
  fine.step = 1e-4;
  double squares = 0;
  for (int i = 0; i < 64; ++i) {
    const rom::LumpedModel model = s.curves.model(s.vehicle.radio, s.drawn[i], fine);
    const double truth = model.predict(c.start, {c.throttle, durations[i]}, s.vehicle.radio, trial).energy_margin;
    if (std::abs(truth) > 5e-3) {
      EXPECT_EQ(told[i].energy_margin > 0, truth > 0) << i;
    }
    squares += std::pow(told[i].energy_margin - truth, 2);
  }
  EXPECT_LT(std::sqrt(squares / 64), 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Trials, EnsembleAtItsOwnStep,
                         testing::Values(Case{"boom_F", F, vehicle::Mount::BOOM, false, 0, 0.61, 0.16},
                                         Case{"boom_Q", Q, vehicle::Mount::BOOM, false, 0, 1.0, 0.60},
                                         Case{"wings_F", F, vehicle::Mount::FREE, true, 0, 0.61, 0.20},
                                         Case{"wings_Q", Q, vehicle::Mount::FREE, true, 0, 1.0, 0.75}),
                         [](const auto& tried) { return std::string(tried.param.name); });

TEST(Ensemble, IsTheSameForEveryWidthOfVectors) {
  // The bits of a trial by the plain code and by the widest that this processor has.
  const Shipped s(20);
  for (const bool wings : {false, true}) {
    for (const auto start : {F, Q}) {
      vehicle::Trial trial;
      trial.mount = vehicle::Mount::FREE;
      trial.wings = wings;
      const vehicle::Pulse pulse{start == F ? 0.61 : 1.0};
      const std::vector<double> durations(20, start == F ? 0.2 : 0.75);
      const auto widest = s.ensemble(8e-3).predict(start, pulse, durations, trial, 0, 20);
      const auto plain = s.ensemble(8e-3, rom::Vectors::PLAIN).predict(start, pulse, durations, trial, 0, 20);
      for (int i = 0; i < 20; ++i) {
        EXPECT_EQ(widest[i].energy_margin, plain[i].energy_margin) << i;
        EXPECT_EQ(widest[i].peak_travel, plain[i].peak_travel) << i;
      }
    }
  }
}

TEST(Ensemble, DoesNotCareWhoIsBesideIt) {
  // Neighbours with other pulses take other steps and have their events at other times.
  const Shipped s(21);
  vehicle::Trial trial;
  trial.mount = vehicle::Mount::FREE;
  std::vector<double> durations;
  for (int i = 0; i < 21; ++i) durations.push_back(0.1 + 0.01 * i);
  const rom::Ensemble ensemble = s.ensemble(8e-3);
  const auto all = ensemble.predict(F, {0.61}, durations, trial, 0, 21);
  for (int i = 0; i < 21; ++i) {
    const auto alone = ensemble.predict(F, {0.61}, durations, trial, i, 1);
    EXPECT_EQ(all[i].energy_margin, alone[0].energy_margin) << i;
    EXPECT_EQ(all[i].peak_travel, alone[0].peak_travel) << i;
  }
}

TEST(Ensemble, KnowsWhoIsNotCalmWithinTheHorizon) {
  // A margin that is decided early must not hide that the vehicle still rings when the time is over.
  Shipped s(12);
  for (std::size_t i = 0; i < s.drawn.size(); ++i) s.drawn[i].damping *= i % 3 == 0 ? 1.0 : i % 3 == 1 ? 0.4 : 0.0;
  const rom::Ensemble ensemble = s.ensemble();
  const auto trial_of = [](double horizon) {
    vehicle::Trial trial;
    trial.wings = false;
    trial.horizon = horizon;
    return trial;
  };
  int calm = 0, ringing = 0;
  for (const auto start : {F, Q}) {
    const vehicle::Pulse pulse = start == F ? vehicle::Pulse{0.61, 0.20} : vehicle::Pulse{1.0, 0.60};
    const std::vector<double> durations(s.drawn.size(), pulse.duration);
    for (const double horizon : {0.2, 0.4, 0.6, 0.8, 1.2, 2.0, 4.0}) {
      const auto told = ensemble.predict(start, pulse, durations, trial_of(horizon), 0, ensemble.size());
      for (int i = 0; i < ensemble.size(); ++i) {
        const rom::LumpedModel model = s.curves.model(s.vehicle.radio, s.drawn[i]);
        const auto margin_by = [&](double time) {
          return model.predict(start, pulse, s.vehicle.radio, trial_of(time)).energy_margin;
        };
        const bool is_calm = margin_by(horizon) != -1.0;
        // Who becomes calm just then may be judged either way.
        if ((margin_by(horizon - 0.03) != -1.0) != is_calm || (margin_by(horizon + 0.03) != -1.0) != is_calm) continue;
        EXPECT_EQ(told[i].energy_margin != -1.0, is_calm)
            << vehicle::modeName(start) << ", horizon " << horizon << ", vehicle " << i;
        ++(is_calm ? calm : ringing);
      }
    }
  }
  EXPECT_GT(calm, 30);
  EXPECT_GT(ringing, 30);
}

TEST(Ensemble, FollowsTheForceBeyondTheLowEndOfTheTable) {
  // A light vehicle with strong motors swings far below the table after the pulse.
  Shipped s(0);
  vehicle::VehicleParameters p = vehicle::realise(s.vehicle, s.table);
  p.ring_mass = 0.348283, p.centre_mass = 0.44166, p.force_scale = 0.889844, p.damping = 1.97787;
  p.max_thrust = 36.5387, p.time_constant_up = 0.035293, p.time_constant_down = 0.0392773;
  p.quadratic_share = 0.781836, p.latency = 0.0356445, p.ring_drag = 0.0279851, p.centre_drag = 0.0022983;
  p.boom_mass = 0.0890583, p.boom_drag = 0.00466944, p.boom_friction = 0.0591797;
  s.drawn.push_back(p);
  vehicle::Trial trial;
  trial.mount = vehicle::Mount::BOOM;
  const rom::SnapPrediction truth = s.curves.model(s.vehicle.radio, p).predict(Q, {1.0, 0.785}, s.vehicle.radio, trial);
  ASSERT_TRUE(truth.snapped);
  ASSERT_LT(truth.least_travel, s.table.travel.front() - 5e-3);
  const auto told = s.ensemble(1e-3).predict(Q, {1.0}, {0.785}, trial, 0, 1);
  EXPECT_TRUE(told[0].snapped);
  EXPECT_NEAR(told[0].energy_margin, truth.energy_margin, 0.03);
  EXPECT_NEAR(told[0].peak_travel, truth.peak_travel, 2e-4);
}

TEST(Ensemble, RefusesByName) {
  const Shipped s(2);
  const rom::Ensemble ensemble = s.ensemble();
  const vehicle::Trial trial;
  EXPECT_THROW(ensemble.predict(vehicle::Mode::UNKNOWN, {0.5}, {0.1, 0.1}, trial, 0, 2), common::Error);
  EXPECT_THROW(ensemble.predict(F, {1.5}, {0.1, 0.1}, trial, 0, 2), common::Error);
  EXPECT_THROW(ensemble.predict(F, {NAN}, {0.1, 0.1}, trial, 0, 2), common::Error);
  EXPECT_THROW(ensemble.predict(F, {0.5}, {0.1}, trial, 0, 2), common::Error);
  EXPECT_THROW(ensemble.predict(F, {0.5}, {0.1, -0.1}, trial, 0, 2), common::Error);
  EXPECT_THROW(ensemble.predict(F, {0.5}, {0.1, 0.1}, trial, 1, 2), common::Error);
  rom::EnsembleSettings settings;
  settings.model.step = 0.02;
  EXPECT_THROW(rom::Ensemble(s.curves, s.vehicle.radio, settings), common::Error);
}

}  // namespace
