// What acts on the plant's two bodies: arms, rotors, drag, hand.
#include <algorithm>
#include <cmath>

#include "snapwing/common/pulse.h"
#include "snapwing/dynamics/plant.h"

namespace snapwing::dynamics {

namespace {

constexpr double FRICTION_SPEED = 0.01;  // [m/s] width of the Coulomb friction's step
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

}  // namespace

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
  const double bound =
      mass * (travel > features_.barrier_travel ? settings_.hand_deceleration_q : settings_.hand_deceleration_f);
  // It feels what the motors still push and holds against it: else idle motors would keep the boom creeping.
  return -std::clamp(mass * ring_speed / HAND_TIME, -bound, bound) - thrust;
}

Plant::Rates Plant::accelerations(double ring_position, double ring_speed, double centre_position, double centre_speed,
                                  double thrust) const {
  const double travel = ring_position - centre_position;
  const double arms = armForce(travel) + parameters_.damping * (ring_speed - centre_speed);
  Rates rates;
  const double centre_drag = parameters_.centre_drag * std::abs(centre_speed) * centre_speed;
  rates.centre = (arms - centre_drag) / parameters_.centre_mass - settings_.gravity;
  if (ringFixed()) return rates;
  const double ring_drag = ring_drag_ * std::abs(ring_speed) * ring_speed;
  const double rub = friction_ * std::tanh(ring_speed / FRICTION_SPEED);
  rates.ring =
      (thrust - ring_drag - rub + handForce(ring_speed, travel, thrust) - arms) / ring_mass_ - settings_.gravity;
  return rates;
}

double Plant::thrustAfter(double dt, std::vector<double>* each) const {
  const double per_rotor = parameters_.max_thrust / static_cast<double>(outputs_.size());
  double total = 0;
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    const double wanted = per_rotor * common::thrustFraction(parameters_.quadratic_share, outputs_[i]);
    const double now = state_.rotor_thrust[i];
    const double lag = wanted > now ? parameters_.time_constant_up : parameters_.time_constant_down;
    const double then = wanted + (now - wanted) * std::exp(-dt / lag);
    if (each) (*each)[i] = then;
    total += then;
  }
  return total;
}

}  // namespace snapwing::dynamics
