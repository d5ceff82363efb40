// What acts on the plant's two bodies: arms, rotors, drag, hand, wings.
#include <algorithm>
#include <cmath>
#include <utility>

#include "snapwing/standin/plant.h"
#include "snapwing/vehicle/pulse.h"

namespace snapwing::standin {

namespace {

constexpr double FRICTION_SPEED = 0.01;  // [m/s] width of the Coulomb friction's step
constexpr double PIN_SPEED = 0.01;       // [m/s] likewise of the wings' pins
constexpr double HAND_TIME = 0.05;       // [s] the hand brakes in proportion to the speed below its bound

/// Interval of the table and place in it.
struct Place {
  std::size_t k;
  double h, t;
};

Place findPlace(const std::vector<double>& knots, double u) {
  const auto above = std::upper_bound(knots.begin(), knots.end(), u);
  const std::size_t k =
      std::clamp<std::ptrdiff_t>(above - knots.begin() - 1, 0, static_cast<std::ptrdiff_t>(knots.size()) - 2);
  const double h = knots[k + 1] - knots[k];
  return {k, h, (u - knots[k]) / h};
}

/// Cubic through values and slopes at both ends of an interval.
double cubic(const std::vector<double>& value, const std::vector<double>& slope, const Place& p) {
  const double r = 1.0 - p.t;
  return r * r * ((1.0 + 2.0 * p.t) * value[p.k] + p.t * p.h * slope[p.k]) +
         p.t * p.t * ((1.0 + 2.0 * r) * value[p.k + 1] - r * p.h * slope[p.k + 1]);
}

/// Value and slope of the cubic through the values around an interval, with slopes from the neighbours (Catmull-Rom)
/// and none at the ends, where the constant goes on: a kink would cost the integrator its order.
std::pair<double, double> smooth(const std::vector<double>& x, const std::vector<double>& y, const Place& p) {
  const auto across = [&](std::size_t i) {
    return i == 0 || i + 1 == x.size() ? 0.0 : (y[i + 1] - y[i - 1]) / (x[i + 1] - x[i - 1]) * p.h;
  };
  const double m0 = across(p.k), m1 = across(p.k + 1);
  const double rise = y[p.k + 1] - y[p.k], c2 = 3 * rise - 2 * m0 - m1, c3 = m0 + m1 - 2 * rise;
  return {y[p.k] + p.t * (m0 + p.t * (c2 + p.t * c3)), (m0 + p.t * (2 * c2 + p.t * 3 * c3)) / p.h};
}

}  // namespace

Plant::Moved Plant::movedAt(double travel) const {
  Moved sum;
  const auto add = [&](const std::vector<double>& knots, const std::vector<double>& kinetic,
                       const std::vector<double>& coupled, double scale) {
    const double inside = std::clamp(travel, knots.front(), knots.back());
    const Place p = findPlace(knots, inside);
    const double slopes = inside == travel ? scale : 0.0;  // constant beyond the table
    const auto [k, k_slope] = smooth(knots, kinetic, p);
    const auto [s, s_slope] = smooth(knots, coupled, p);
    sum.kinetic += scale * k;
    sum.coupled += scale * s;
    sum.kinetic_slope += slopes * k_slope;
    sum.coupled_slope += slopes * s_slope;
  };
  add(table_.travel, table_.kinetic_mass, table_.coupled_mass, table_.arm_count);
  if (!wing_) return sum;
  add(wing_->travel, wing_->kinetic_mass, wing_->coupled_mass, parameters_.wing_inertia);
  sum.friction = parameters_.wing_friction * wing_->at(wing_->friction_force, travel);
  return sum;
}

double Plant::travelMass(double travel) const {
  const Moved w = movedAt(travel);
  const double centre = parameters_.centre_mass, lag = centre - w.coupled;
  return centre + w.kinetic - (ringFixed() ? 0.0 : lag * lag / (ring_mass_ + centre));
}

double Plant::armForce(double travel) const {
  const double scale = table_.arm_count * parameters_.force_scale;
  // Beyond the table the last stiffness goes on; the stops are not far.
  const double inside = std::clamp(travel, table_.travel.front(), table_.travel.back());
  double force = cubic(table_.force, table_.stiffness, findPlace(table_.travel, inside));
  if (travel > inside) force += table_.stiffness.back() * (travel - inside);
  if (travel < inside) force += table_.stiffness.front() * (travel - inside);
  return scale * force;
}

double Plant::armEnergy(double travel) const {
  const double scale = table_.arm_count * parameters_.force_scale;
  const double inside = std::clamp(travel, table_.travel.front(), table_.travel.back());
  const double beyond = travel - inside;
  const double energy = cubic(table_.energy, table_.force, findPlace(table_.travel, inside));
  const double stiffness = beyond > 0 ? table_.stiffness.back() : table_.stiffness.front();
  const double force = beyond > 0 ? table_.force.back() : table_.force.front();
  return scale * (energy + beyond * (force + 0.5 * stiffness * beyond));
}

double Plant::armRotation() const {
  if (table_.rotation.size() != table_.travel.size()) return 0.0;
  const Place p = findPlace(table_.travel, std::clamp(state_.travel(), table_.travel.front(), table_.travel.back()));
  return (1.0 - p.t) * table_.rotation[p.k] + p.t * table_.rotation[p.k + 1];
}

double Plant::handForce(double ring_speed, double travel, double thrust) const {
  if (!hand_) return 0.0;
  const double mass = ring_mass_ + parameters_.centre_mass;
  // The experimenter sees the shape and is gentle where a jerk would flip it.
  const double held_by_q = -parameters_.force_scale * features_.valley_force / parameters_.centre_mass;
  const double bound =
      mass * (travel > features_.barrier_travel ? settings_.hand_share_q * held_by_q : settings_.hand_deceleration_f);
  // It feels what the motors still push and holds against it: else idle motors would keep the boom creeping.
  return -std::clamp(mass * ring_speed / HAND_TIME, -bound, bound) - thrust;
}

Plant::Rates Plant::accelerations(double ring_position, double ring_speed, double centre_position, double centre_speed,
                                  double thrust) const {
  const double travel = ring_position - centre_position, rate = ring_speed - centre_speed;
  const Moved w = movedAt(travel);
  const double pins = wing_ ? w.friction * std::tanh(rate / PIN_SPEED) : 0.0;
  const double arms = armForce(travel) + parameters_.damping * rate + pins;
  const double turn = 0.5 * w.kinetic_slope * rate * rate, lift = w.coupled * settings_.gravity;
  const double centre_drag = parameters_.centre_drag * std::abs(centre_speed) * centre_speed;
  // Lagrange's equations in z_r and z_c for T = m_r z_r'^2 / 2 + m_c z_c'^2 / 2 + S z_r' u' + K u'^2 / 2.
  const double mass_c = parameters_.centre_mass;
  const double on_centre = arms - centre_drag - mass_c * settings_.gravity + lift + turn;
  Rates rates;
  if (ringFixed()) {
    rates.centre = on_centre / (mass_c + w.kinetic);
    return rates;
  }
  const double ring_drag = ring_drag_ * std::abs(ring_speed) * ring_speed;
  const double rub = friction_ * std::tanh(ring_speed / FRICTION_SPEED);
  const double on_ring = thrust - ring_drag - rub + handForce(ring_speed, travel, thrust) + push_ - arms -
                         ring_mass_ * settings_.gravity - lift - turn - w.coupled_slope * rate * rate;
  const double m11 = ring_mass_ + 2 * w.coupled + w.kinetic, m12 = -w.coupled - w.kinetic, m22 = mass_c + w.kinetic;
  const double det = m11 * m22 - m12 * m12;
  rates.ring = (m22 * on_ring - m12 * on_centre) / det;
  rates.centre = (m11 * on_centre - m12 * on_ring) / det;
  return rates;
}

double Plant::thrustAfter(double dt, std::vector<double>* each) const {
  const double per_rotor = parameters_.max_thrust / static_cast<double>(outputs_.size());
  double total = 0;
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    const double wanted = per_rotor * vehicle::thrustFraction(parameters_.quadratic_share, outputs_[i]);
    const double now = state_.rotor_thrust[i];
    const double lag = wanted > now ? parameters_.time_constant_up : parameters_.time_constant_down;
    const double then = wanted + (now - wanted) * std::exp(-dt / lag);
    if (each) (*each)[i] = then;
    total += then;
  }
  return total;
}

}  // namespace snapwing::standin
