#pragma once
/// Masses and motors of a vehicle without losses, and what its motion must keep.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "snapwing/rom/lumped_model.h"

namespace snapwing::rom::testing {

inline vehicle::VehicleParameters plainParameters() {
  vehicle::VehicleParameters p;
  p.ring_mass = 0.383;
  p.centre_mass = 0.40;
  p.max_thrust = 35.6;
  p.time_constant_up = p.time_constant_down = 0.05;
  p.quadratic_share = 0.8;
  return p;
}

/// Fast enough to pass the barrier again and again.
inline LumpedState inMotion() {
  LumpedState state;
  state.travel = 0.010;
  state.ring_speed = 0.9;
  state.centre_speed = -0.4;
  return state;
}

/// Without loads and losses energy and momentum stay, over 50 s, to rounding.
inline void expectInvariantsKept(const LumpedModel& model) {
  const vehicle::Trial trial;
  LumpedState state = inMotion();
  const double energy = model.relativeEnergy(state, trial), speed = model.commonSpeed(state, trial);
  double drift = 0;
  int crossings = 0;
  for (int i = 0; i < 50000; ++i) {
    const LumpedState next = model.step(state, 0.0, 1e-3, trial);
    crossings += (next.travel > 0.0277) != (state.travel > 0.0277);
    state = next;
    drift = std::max(drift, std::abs(model.relativeEnergy(state, trial) - energy));
  }
  EXPECT_GT(crossings, 100);
  EXPECT_LT(drift, 1e-9 * energy);
  EXPECT_NEAR(model.commonSpeed(state, trial), speed, 1e-9);
}

}  // namespace snapwing::rom::testing
