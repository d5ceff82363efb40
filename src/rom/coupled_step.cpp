// A step of the lumped model with arms and wings, whose inertia depends on the travel.
#include <cmath>

#include "resistance.h"
#include "snapwing/rom/lumped_model.h"

namespace snapwing::rom {

namespace {

/// Arms and wings at one travel and the inertia that they give the relative motion.
struct Inertia : RelativeInertia {
  Inertia(const TravelInertia& curve, double travel, double centre, double all) : moved(curve.at(travel)) {
    static_cast<RelativeInertia&>(*this) = relativeInertia(moved, centre, all);
  }
  InertiaSample moved;
};

/// Difference quotient over the step, with its slope in the end travel; for short steps by the slopes at both ends.
Resistance quotient(double value0, double slope0, double value1, double slope1, double du) {
  if (std::abs(du) < 1e-7) return {0.5 * (slope0 + slope1), 0.0};
  const double q = (value1 - value0) / du;
  return {q, (slope1 - q) / du};
}

}  // namespace

// Unknowns: the common momentum p = (m_r + m_c) z' - (m_c - S) u' and the rate w = u', both at the middle of the step.
// With m, S at both ends, [x] = x1 - x0 and <x> = (x0 + x1) / 2
//   [p] / dt = P                                  P: thrust, drag, friction, weight of the whole
//   <m> [w] / dt + [m]/[u] (w0^2 + w1^2) / 4 = - [E]/[u] - c <w> - pins + D_c + m_c g - [H]/[u] g
//                                              + (m_c - [H]/[u]) P / (m_r + m_c)
// The left side times [u] is exactly [m w^2 / 2]: without loads and losses the energy is kept to rounding.
void LumpedModel::coupledStep(const LumpedState& state, double mean_thrust, double dt, const vehicle::Trial& trial,
                              const TravelInertia& moved, LumpedState* next) const {
  const vehicle::VehicleParameters& parameters = parameters_;
  const bool held = trial.mount == vehicle::Mount::HELD;
  const double centre = parameters.centre_mass, g = trial.gravity;
  const double all = held ? INFINITY : ringMass(trial) + centre;
  const double u0 = state.travel, w0 = state.travelRate();
  const Inertia begin(moved, u0, centre, all);
  const double p0 = held ? 0.0 : all * state.ring_speed - begin.lag * w0;
  const double energy0 = potential_->energy(u0);
  const double pins = moved.at(u0 + 0.5 * dt * w0).friction;

  double p = p0, w = w0, ring = 0;
  Inertia end = begin;
  for (int i = 0; i < 25; ++i) {
    const double u1 = u0 + dt * w, du = u1 - u0, w1 = 2.0 * w - w0;
    end = Inertia(moved, u1, centre, all);
    const double mass = 0.5 * (begin.mass + end.mass), squares = 0.25 * (w0 * w0 + w1 * w1);
    const Resistance turn = quotient(begin.mass, begin.mass_slope, end.mass, end.mass_slope, du);
    const Resistance coupled =
        quotient(begin.moved.mass_moment, begin.moved.coupled_mass, end.moved.mass_moment, end.moved.coupled_mass, du);
    const Resistance elastic = elasticForce(*potential_, u0, energy0, u1);
    const Resistance rub = coulomb(pins, w, settings_.friction_speed);
    const double lag = centre - coupled.force, lag_slope = -dt * coupled.slope;

    ring = held ? 0.0 : (p + lag * w) / all;
    const double ring_slope = held ? 0.0 : (lag + lag_slope * w) / all;  // in w; in p it is 1 / all
    const Resistance dc = drag(parameters.centre_drag, ring - w);
    double push = 0, push_p = 0, push_w = 0;
    if (!held) {
      const RingResistance against = ringResistance(ring, trial);
      push = mean_thrust - against.force - dc.force - all * g;
      push_p = -(against.slope + dc.slope) / all;
      push_w = -against.slope * ring_slope - dc.slope * (ring_slope - 1.0);
    }
    const double share = held ? 0.0 : lag / all, share_slope = held ? 0.0 : lag_slope / all;
    const double residual_p = 2.0 / dt * (p - p0) - push;
    const double residual_w = mass * 2.0 / dt * (w - w0) + turn.force * squares + elastic.force +
                              parameters.damping * w + rub.force - dc.force - lag * g - share * push;
    const double jpp = 2.0 / dt - push_p, jpw = -push_w;
    const double jwp = held ? 0.0 : -dc.slope / all - share * push_p;
    const double jww = 2.0 / dt * mass + end.mass_slope * (w - w0) + dt * turn.slope * squares + turn.force * w1 +
                       dt * elastic.slope + parameters.damping + rub.slope - dc.slope * (ring_slope - 1.0) -
                       lag_slope * g - share_slope * push - share * push_w;
    const double det = jpp * jww - jpw * jwp;
    const double move_p = held ? 0.0 : -(jww * residual_p - jpw * residual_w) / det;
    const double move_w = held ? -residual_w / jww : -(jpp * residual_w - jwp * residual_p) / det;
    p += move_p;
    w += move_w;
    if (std::abs(move_p) + std::abs(move_w) < settings_.convergence * (1.0 + std::abs(p) + std::abs(w))) break;
  }
  const double w1 = 2.0 * w - w0, p1 = 2.0 * p - p0;
  next->travel = u0 + dt * w;
  const Inertia last(moved, next->travel, centre, all);
  if (!held) {
    next->ring_speed = (p1 + last.lag * w1) / all;
    next->position = state.position + dt * ring;
  }
  next->centre_speed = next->ring_speed - w1;
}

}  // namespace snapwing::rom
