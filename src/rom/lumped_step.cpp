#include <cmath>

#include "resistance.h"
#include "snapwing/rom/lumped_model.h"
#include "snapwing/vehicle/rotor_lag.h"

namespace snapwing::rom {

LumpedState LumpedModel::step(const LumpedState& state, double demand, double dt, const vehicle::Trial& trial) const {
  const vehicle::VehicleParameters& p = parameters_;
  LumpedState next = state;
  next.time = state.time + dt;

  // Thrust: exact lag; its mean over the step drives the bodies.
  const vehicle::LaggedThrust thrust =
      vehicle::laggedThrust(state.thrust, demand * p.max_thrust, p.time_constant_up, p.time_constant_down, dt);
  next.thrust = thrust.end;
  const double mean_thrust = thrust.mean;

  if (const TravelInertia* moved = inertiaOf(trial)) {
    coupledStep(state, mean_thrust + trial.push, dt, trial, *moved, &next);
  } else {
    plainStep(state, mean_thrust + trial.push, dt, trial, &next);
  }
  return next;
}

void LumpedModel::plainStep(const LumpedState& state, double mean_thrust, double dt, const vehicle::Trial& trial,
                            LumpedState* next) const {
  const vehicle::VehicleParameters& p = parameters_;
  const bool held = trial.mount == vehicle::Mount::HELD;
  const double ring_mass = ringMass(trial);
  const double inertia_r = 2.0 * ring_mass / dt, inertia_c = 2.0 * p.centre_mass / dt;
  const double energy0 = potential_->energy(state.travel);

  // Unknowns: the two speeds at the middle of the step.
  double vr = held ? 0.0 : state.ring_speed, vc = state.centre_speed;
  for (int i = 0; i < 25; ++i) {
    const double rate = vr - vc;
    const Resistance elastic = elasticForce(*potential_, state.travel, energy0, state.travel + dt * rate);
    const double arms = elastic.force + p.damping * rate;
    const double arms_slope = dt * elastic.slope + p.damping;
    const Resistance dc = drag(p.centre_drag, vc);
    const double residual_c = inertia_c * (vc - state.centre_speed) + dc.force - arms + p.centre_mass * trial.gravity;
    const double slope_c = inertia_c + dc.slope + arms_slope;
    double move_r = 0, move_c = 0;
    if (held) {
      move_c = -residual_c / slope_c;
    } else {
      const RingResistance against = ringResistance(vr, trial);
      const double residual_r =
          inertia_r * (vr - state.ring_speed) - mean_thrust + against.force + arms + ring_mass * trial.gravity;
      const double slope_r = inertia_r + against.slope + arms_slope;
      const double det = slope_r * slope_c - arms_slope * arms_slope;
      move_r = -(slope_c * residual_r + arms_slope * residual_c) / det;
      move_c = -(arms_slope * residual_r + slope_r * residual_c) / det;
    }
    vr += move_r;
    vc += move_c;
    if (std::abs(move_r) + std::abs(move_c) < settings_.convergence * (1.0 + std::abs(vr) + std::abs(vc))) break;
  }
  if (!held) {
    next->ring_speed = 2.0 * vr - state.ring_speed;
    next->position = state.position + dt * vr;
  }
  next->centre_speed = 2.0 * vc - state.centre_speed;
  next->travel = state.travel + dt * (vr - vc);
}

}  // namespace snapwing::rom
