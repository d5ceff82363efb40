#include <cmath>

#include "snapwing/rom/lumped_model.h"

namespace snapwing::rom {

namespace {

/// Force against motion and its slope.
struct Resistance {
  double force = 0, slope = 0;
};

Resistance drag(double coefficient, double speed) {
  const double k = coefficient * std::abs(speed);
  return {k * speed, 2.0 * k};
}

Resistance coulomb(double friction, double speed, double width) {
  const double r = 1.0 / std::sqrt(speed * speed + width * width);
  return {friction * speed * r, friction * width * width * r * r * r};
}

/// Elastic force over a step and its slope in the end travel: the discrete gradient, which does exactly the work that
/// the energy loses. For steps too short for the quotient it is the force at the middle.
Resistance elasticForce(const Potential& potential, double u0, double energy0, double u1) {
  const double du = u1 - u0;
  if (std::abs(du) < 1e-7) {
    const PotentialSample middle = potential.at(u0 + 0.5 * du);
    return {middle.force, 0.5 * middle.stiffness};
  }
  const PotentialSample end = potential.at(u1);
  const double force = (end.energy - energy0) / du;
  return {force, (end.force - force) / du};
}

}  // namespace

LumpedState LumpedModel::step(const LumpedState& state, double demand, double dt, const Trial& trial) const {
  const common::VehicleParameters& p = parameters_;
  LumpedState next = state;
  next.time = state.time + dt;

  // Thrust: exact lag; its mean over the step drives the bodies.
  const double wanted = demand * p.max_thrust;
  const double lag = wanted > state.thrust ? p.time_constant_up : p.time_constant_down;
  const double decay = -std::expm1(-dt / lag);
  next.thrust = state.thrust + (wanted - state.thrust) * decay;
  const double mean_thrust = wanted + (state.thrust - wanted) * decay * lag / dt;

  const bool held = trial.mount == Mount::HELD;
  const bool boom = trial.mount == Mount::BOOM;
  const double ring_mass = p.ring_mass + (boom ? p.boom_mass : 0.0);
  const double ring_drag = p.ring_drag + (boom ? p.boom_drag : 0.0);
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
      const Resistance dr = drag(ring_drag, vr);
      const Resistance rub = boom ? coulomb(p.boom_friction, vr, settings_.friction_speed) : Resistance{};
      const double residual_r =
          inertia_r * (vr - state.ring_speed) - mean_thrust + dr.force + rub.force + arms + ring_mass * trial.gravity;
      const double slope_r = inertia_r + dr.slope + rub.slope + arms_slope;
      const double det = slope_r * slope_c - arms_slope * arms_slope;
      move_r = -(slope_c * residual_r + arms_slope * residual_c) / det;
      move_c = -(arms_slope * residual_r + slope_r * residual_c) / det;
    }
    vr += move_r;
    vc += move_c;
    if (std::abs(move_r) + std::abs(move_c) < 1e-13 * (1.0 + std::abs(vr) + std::abs(vc))) break;
  }
  if (!held) {
    next.ring_speed = 2.0 * vr - state.ring_speed;
    next.position = state.position + dt * vr;
  }
  next.centre_speed = 2.0 * vc - state.centre_speed;
  next.travel = state.travel + dt * (vr - vc);
  return next;
}

}  // namespace snapwing::rom
