#include "snapwing/standin/plant.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "snapwing/common/error.h"
#include "snapwing/common/require.h"
#include "snapwing/common/uniform.h"

namespace snapwing::standin {

namespace {
constexpr double REST_SPEED = 0.02;  // [m/s] ring and relative motion count as still below
constexpr double LOCK_SPEED = 0.01;  // [m/s] the hand holds firmly below

const common::Require require("plant");
}  // namespace

void PlantSettings::validate() const {
  require(std::abs(gravity) <= 100.0, "gravity", gravity, "-100 .. 100 m/s2");
  require(step > 0 && step <= 1e-3, "step", step, "above 0, up to 0.001 s");
  require(stop_restitution >= 0 && stop_restitution <= 1, "stop_restitution", stop_restitution, "0 .. 1");
  require(hand_share_q > 0 && hand_share_q < 1, "hand_share_q", hand_share_q, "between 0 and 1");
  require(hand_deceleration_f > 0 && std::isfinite(hand_deceleration_f), "hand_deceleration_f", hand_deceleration_f,
          "above 0 m/s2");
  if (wings.value_or(false) && mount == vehicle::Mount::BOOM) vehicle::refuseWingsOnBoom("plant");
}

double PlantState::thrust() const { return std::accumulate(rotor_thrust.begin(), rotor_thrust.end(), 0.0); }

Plant::Plant(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table,
             const vehicle::VehicleParameters& parameters, const PlantSettings& settings,
             const std::optional<vehicle::WingTable>& wing)
    : parameters_(parameters), settings_(settings), table_(table) {
  settings_.validate();
  table_.validate();
  features_ = vehicle::curveFeatures(table_);
  const vehicle::VehicleParameters& p = parameters_;
  require(p.ring_mass > 0 && p.centre_mass > 0, "mass", std::min(p.ring_mass, p.centre_mass), "above 0 kg");
  require(p.time_constant_up > 0 && p.time_constant_down > 0, "time constant",
          std::min(p.time_constant_up, p.time_constant_down), "above 0 s");
  require(vehicle.rotors.count >= 1, "rotors", vehicle.rotors.count, "1 or more");
  require(p.wing_inertia > 0 && std::isfinite(p.wing_inertia), "wing_inertia", p.wing_inertia, "above 0");
  require(p.wing_friction >= 0 && std::isfinite(p.wing_friction), "wing_friction", p.wing_friction, "0 or more");
  if (settings_.wings.value_or(wing && settings_.mount != vehicle::Mount::BOOM)) {
    if (!wing) throw common::Error("plant: wings are on, but there is no table of them");
    wing->validate();
    if (wing->kinetic_mass.empty() || wing->coupled_mass.empty() || wing->friction_force.empty()) {
      throw common::Error("plant: the wing's table has no inertia; allowed: a table made with a blade");
    }
    wing_ = *wing;
  }
  travel_min_ = vehicle.limits.travel_min;
  travel_max_ = vehicle.limits.travel_max;
  const bool boom = settings_.mount == vehicle::Mount::BOOM;
  if (boom) vehicle.requireBoom("the simulation");
  ring_mass_ = p.ring_mass + (boom ? p.boom_mass : 0.0);
  ring_drag_ = p.ring_drag + (boom ? p.boom_drag : 0.0);
  friction_ = boom ? p.boom_friction : 0.0;
  outputs_.assign(vehicle.rotors.count, 0.0);
  state_.rotor_thrust.assign(vehicle.rotors.count, 0.0);
}

void Plant::reset(vehicle::Mode mode) {
  if (mode == vehicle::Mode::UNKNOWN) throw common::Error("plant: reset to an unknown mode; allowed: F or Q");
  if (!features_.bistable) throw common::Error("plant: the force table is not bistable");
  const double time = state_.time;
  const std::size_t rotors = outputs_.size();
  state_ = PlantState{};
  state_.time = time;
  state_.rotor_thrust.assign(rotors, 0.0);
  outputs_.assign(rotors, 0.0);
  hand_ = locked_ = false;
  push_ = 0;
  state_.centre_position = mode == vehicle::Mode::QUADROTOR ? -features_.second_travel : 0.0;
}

void Plant::setMotorOutputs(const std::vector<double>& outputs) {
  require(outputs.size() == outputs_.size(), "number of motor outputs", static_cast<double>(outputs.size()),
          "one per rotor");
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    outputs_[i] = std::isfinite(outputs[i]) ? std::clamp(outputs[i], 0.0, 1.0) : 0.0;
  }
}

void Plant::advanceTo(double time) {
  const double span = time - state_.time;
  if (!(span > 0)) return;
  const int count = std::max(1, static_cast<int>(std::ceil(span / settings_.step - 1e-9)));
  const double begin = state_.time;
  for (int i = 0; i < count; ++i) {
    stepOnce(span / count);
    state_.time = i + 1 == count ? time : begin + span * (i + 1) / count;
  }
}

void Plant::stepOnce(double dt) {
  const double thrust0 = state_.thrust();
  const double thrust1 = thrustAfter(0.5 * dt, nullptr);
  std::vector<double> rotor_thrust(outputs_.size());
  const double thrust2 = thrustAfter(dt, &rotor_thrust);
  const double zr = state_.ring_position, vr = state_.ring_speed;
  const double zc = state_.centre_position, vc = state_.centre_speed;
  const double half = 0.5 * dt;
  // Classical Runge-Kutta on (position, speed) of both bodies.
  const Rates a = accelerations(zr, vr, zc, vc, thrust0);
  const double vr1 = vr + half * a.ring, vc1 = vc + half * a.centre;
  const Rates b = accelerations(zr + half * vr, vr1, zc + half * vc, vc1, thrust1);
  const double vr2 = vr + half * b.ring, vc2 = vc + half * b.centre;
  const Rates c = accelerations(zr + half * vr1, vr2, zc + half * vc1, vc2, thrust1);
  const double vr3 = vr + dt * c.ring, vc3 = vc + dt * c.centre;
  const Rates d = accelerations(zr + dt * vr2, vr3, zc + dt * vc2, vc3, thrust2);
  state_.ring_position += dt / 6.0 * (vr + 2.0 * vr1 + 2.0 * vr2 + vr3);
  state_.centre_position += dt / 6.0 * (vc + 2.0 * vc1 + 2.0 * vc2 + vc3);
  state_.ring_speed += dt / 6.0 * (a.ring + 2.0 * b.ring + 2.0 * c.ring + d.ring);
  state_.centre_speed += dt / 6.0 * (a.centre + 2.0 * b.centre + 2.0 * c.centre + d.centre);
  state_.rotor_thrust = std::move(rotor_thrust);
  if (state_.travel() > travel_max_) hitStop(travel_max_);
  if (state_.travel() < travel_min_) hitStop(travel_min_);
  if (hand_ && !locked_ && std::abs(state_.ring_speed) < LOCK_SPEED) {
    locked_ = true;
    state_.ring_speed = 0.0;
  }
}

void Plant::hitStop(double limit) {
  const bool outward = (limit == travel_max_) == (state_.travelRate() > 0);
  const double kept = outward ? -settings_.stop_restitution : 1.0;
  // The blow keeps the common momentum, m_r z_r' + m_c z_c' + S u'; a fixed ring takes it all.
  const double lag = parameters_.centre_mass - movedAt(limit).coupled;
  const double share_ring = ringFixed() ? 0.0 : lag / (ring_mass_ + parameters_.centre_mass);
  const double rate_change = (kept - 1.0) * state_.travelRate();
  const double travel_change = limit - state_.travel();
  state_.ring_speed += share_ring * rate_change;
  state_.centre_speed -= (1.0 - share_ring) * rate_change;
  state_.ring_position += share_ring * travel_change;
  state_.centre_position -= (1.0 - share_ring) * travel_change;
}

void Plant::grab() { hand_ = true; }

void Plant::release() { hand_ = locked_ = false; }

void Plant::push(double force) {
  require(std::isfinite(force), "push", force, "a finite force");
  push_ = force;
}

bool Plant::atRest() const {
  return ringFixed() && std::abs(state_.ring_speed) < REST_SPEED && std::abs(state_.travelRate()) < REST_SPEED;
}

Plant::Rates Plant::present() const {
  return accelerations(state_.ring_position, state_.ring_speed, state_.centre_position, state_.centre_speed,
                       state_.thrust());
}

double Plant::ringAcceleration() const { return present().ring; }
double Plant::centreAcceleration() const { return present().centre; }
double Plant::centreSpecificForce() const { return centreAcceleration() + settings_.gravity; }

vehicle::Mode Plant::mode() const {
  if (!features_.bistable) return vehicle::Mode::UNKNOWN;
  const double rate = state_.travelRate();
  const double energy = 0.5 * travelMass(state_.travel()) * rate * rate + armEnergy(state_.travel());
  if (energy >= armEnergy(features_.barrier_travel)) return vehicle::Mode::UNKNOWN;
  return state_.travel() < features_.barrier_travel ? vehicle::Mode::FIXED_WING : vehicle::Mode::QUADROTOR;
}

vehicle::VehicleParameters drawParameters(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table,
                                          std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::vector<double> xi(vehicle::uncertainNames().size());
  for (double& x : xi) x = common::uniformAbout0(engine);
  return vehicle::realise(vehicle, table, xi);
}

}  // namespace snapwing::standin
