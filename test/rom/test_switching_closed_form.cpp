// Dynamic switching of the undamped quartic by a rectangular pulse, against energy thresholds at the barrier's top
// (reference numbers, section 5): 1 % inside and outside.
#include <gtest/gtest.h>

#include <cmath>

#include "quartic.h"

namespace snapwing::rom {
namespace {

using vehicle::Mode;
constexpr double STATIC_LIMIT = 0.384900;

bool passes(Mode start, double force, double duration) {
  vehicle::Trial trial;
  trial.horizon = 15.0;
  const SnapPrediction p = testing::quarticModel(force).predict(start, 1.0, duration, trial);
  return std::isfinite(p.snap_time);
}

TEST(QuarticSwitching, StaticLimitIsTheForcePeak) {
  const testing::Quartic quartic;
  EXPECT_NEAR(quartic.equilibria().peak_force, STATIC_LIMIT, 1e-6);
  EXPECT_NEAR(quartic.equilibria().barrier_first, 0.25, 1e-12);
  EXPECT_NEAR(quartic.equilibria().barrier, 1.0, 1e-12);
}

TEST(QuarticSwitching, ShortestPulseThatSwitches) {
  const double table[][2] = {{0.80, 4.928359}, {1.0, 2.520404}, {1.5, 1.379954},
                             {2.0, 0.980615},  {3.0, 0.630413}, {10.0, 0.184212}};
  for (const auto& row : table) {
    const double force = row[0] * STATIC_LIMIT;
    EXPECT_TRUE(passes(Mode::FIXED_WING, force, 1.01 * row[1])) << row[0];
    EXPECT_FALSE(passes(Mode::FIXED_WING, force, 0.99 * row[1])) << row[0];
  }
}

TEST(QuarticSwitching, StepBelowTheDynamicLimitNeverSwitches) {
  EXPECT_FALSE(passes(Mode::FIXED_WING, 0.99 * 0.769800 * STATIC_LIMIT, 60.0));
  EXPECT_TRUE(passes(Mode::FIXED_WING, 1.01 * 0.769800 * STATIC_LIMIT, 60.0));
}

TEST(QuarticSwitching, ImpulseLimit) {
  const double force = 200.0, impulse = 0.707107;
  EXPECT_TRUE(passes(Mode::FIXED_WING, force, 1.01 * impulse / force));
  EXPECT_FALSE(passes(Mode::FIXED_WING, force, 0.99 * impulse / force));
}

/// Equilibria that are exact in floating point: the force of the start is then equal to no load, to the last bit.
class ExactQuartic : public testing::Quartic {
 public:
  ExactQuartic() : exact_(testing::Quartic::equilibria()) { exact_.first = 0, exact_.barrier = 1, exact_.second = 2; }
  const Equilibria& equilibria() const override { return exact_; }

 private:
  Equilibria exact_;
};

TEST(QuarticSwitching, AStartWithoutALoadIsTheUnloadedEquilibrium) {
  ASSERT_EQ(ExactQuartic().at(0.0).force, 0.0);
  vehicle::VehicleParameters p;
  p.ring_mass = p.centre_mass = 2.0;
  p.max_thrust = 1.0, p.time_constant_up = p.time_constant_down = 1e-9;
  const LumpedModel model(std::make_shared<ExactQuartic>(), p, 0.0, {});
  EXPECT_NEAR(model.startState(Mode::FIXED_WING, {}).travel, 0.0, 1e-12);
  EXPECT_NEAR(model.startState(Mode::QUADROTOR, {}).travel, 2.0, 1e-12);
}

TEST(QuarticSwitching, BackByStorageAndRebound) {
  const double table[][3] = {{1.60, 1.515637, 1.892531}, {2.0, 1.026201, 2.251293}, {3.0, 0.636621, 2.392453}};
  for (const auto& row : table) {
    const double force = row[0] * STATIC_LIMIT;
    EXPECT_FALSE(passes(Mode::QUADROTOR, force, 0.99 * row[1])) << row[0];
    EXPECT_TRUE(passes(Mode::QUADROTOR, force, 1.01 * row[1])) << row[0];
    EXPECT_TRUE(passes(Mode::QUADROTOR, force, 0.99 * row[2])) << row[0];
    EXPECT_FALSE(passes(Mode::QUADROTOR, force, 1.01 * row[2])) << row[0];
  }
  // Below 1.568078 no length helps.
  for (double duration = 0.1; duration < 4.0; duration += 0.1) {
    EXPECT_FALSE(passes(Mode::QUADROTOR, 0.99 * 1.568078 * STATIC_LIMIT, duration)) << duration;
  }
}

TEST(QuarticSwitching, MarginChangesSignWhereTheOutcomeDoes) {
  // A little damping makes the end settle; the margin goes to zero from both sides of the threshold.
  vehicle::Trial trial;
  trial.horizon = 60.0;
  const auto predict = [&](double duration) {
    return testing::quarticModel(2.0 * STATIC_LIMIT, 1e-3, 0.3).predict(Mode::FIXED_WING, 1.0, duration, trial);
  };
  double low = 0.5, high = 1.5;
  ASSERT_LT(predict(low).energy_margin, -0.1);
  ASSERT_GT(predict(high).energy_margin, 0.1);
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (predict(middle).snapped ? high : low) = middle;
  }
  EXPECT_NEAR(predict(low).energy_margin, 0.0, 0.01);
  EXPECT_NEAR(predict(high).energy_margin, 0.0, 0.01);
  EXPECT_FALSE(predict(low).snapped);
  EXPECT_TRUE(predict(high).snapped);
}

}  // namespace
}  // namespace snapwing::rom
