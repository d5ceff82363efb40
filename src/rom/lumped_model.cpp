#include "snapwing/rom/lumped_model.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "margin_watch.h"
#include "snapwing/common/error.h"
#include "snapwing/rom/energy_spline.h"

namespace snapwing::rom {

namespace {

void require(bool good, const std::string& name, double value, const char* allowed) {
  if (!good) throw common::Error("lumped model: " + name + " is " + std::to_string(value) + "; allowed: " + allowed);
}

void requirePositive(const char* name, double value) {
  require(value > 0 && std::isfinite(value), name, value, "above 0");
}

void requireNotNegative(const char* name, double value) {
  require(value >= 0 && std::isfinite(value), name, value, "0 or more");
}

void validate(const common::VehicleParameters& p) {
  requirePositive("ring_mass", p.ring_mass);
  requirePositive("centre_mass", p.centre_mass);
  requirePositive("max_thrust", p.max_thrust);
  requirePositive("time_constant_up", p.time_constant_up);
  requirePositive("time_constant_down", p.time_constant_down);
  require(p.quadratic_share >= 0 && p.quadratic_share <= 1, "quadratic_share", p.quadratic_share, "0 .. 1");
  requireNotNegative("damping", p.damping);
  requireNotNegative("latency", p.latency);
  requireNotNegative("ring_drag", p.ring_drag);
  requireNotNegative("centre_drag", p.centre_drag);
  requireNotNegative("boom_mass", p.boom_mass);
  requireNotNegative("boom_drag", p.boom_drag);
  requireNotNegative("boom_friction", p.boom_friction);
}

}  // namespace

void LumpedSettings::validate() const {
  require(step > 0 && step <= 0.01, "step", step, "above 0, up to 0.01 s");
  require(friction_speed > 0, "friction_speed", friction_speed, "above 0 m/s");
  require(settled_share > 0 && settled_share < 1, "settled_share", settled_share, "between 0 and 1");
}

LumpedModel::LumpedModel(std::shared_ptr<const Potential> potential, const common::VehicleParameters& parameters,
                         double idle_fraction, const LumpedSettings& settings)
    : potential_(std::move(potential)), parameters_(parameters), idle_fraction_(idle_fraction), settings_(settings) {
  if (!potential_) throw common::Error("lumped model: no potential");
  validate(parameters_);
  settings_.validate();
  require(idle_fraction_ >= 0 && idle_fraction_ < 1, "idle_fraction", idle_fraction_, "0 .. below 1");
}

LumpedModel LumpedModel::fromVehicle(const common::Vehicle& vehicle, const common::ForceTable& table,
                                     const common::VehicleParameters& parameters, const LumpedSettings& settings) {
  const double idle = common::thrustFraction(parameters.quadratic_share, common::motorOutput(vehicle.radio, 0.0));
  return LumpedModel(std::make_shared<EnergySpline>(table, parameters.force_scale), parameters, idle, settings);
}

double LumpedModel::thrustFraction(const common::Radio& radio, double throttle) const {
  return common::thrustFraction(parameters_.quadratic_share, common::motorOutput(radio, throttle));
}

double LumpedModel::relativeMass(Mount mount) const {
  const common::VehicleParameters& p = parameters_;
  if (mount == Mount::HELD) return p.centre_mass;
  const double ring = p.ring_mass + (mount == Mount::BOOM ? p.boom_mass : 0.0);
  return ring * p.centre_mass / (ring + p.centre_mass);
}

double LumpedModel::relativeEnergy(const LumpedState& state, Mount mount) const {
  const double rate = state.travelRate();
  return 0.5 * relativeMass(mount) * rate * rate + potential_->energy(state.travel);
}

double LumpedModel::relativeLoad(const LumpedState& state, const Trial& trial) const {
  const common::VehicleParameters& p = parameters_;
  const double centre_drag = p.centre_drag * std::abs(state.centre_speed) * state.centre_speed;
  if (trial.mount == Mount::HELD) return p.centre_mass * trial.gravity + centre_drag;
  const bool boom = trial.mount == Mount::BOOM;
  const double v = state.ring_speed;
  double push = state.thrust - (p.ring_drag + (boom ? p.boom_drag : 0.0)) * std::abs(v) * v;
  if (boom) push -= p.boom_friction * v / std::sqrt(v * v + settings_.friction_speed * settings_.friction_speed);
  const double ring = p.ring_mass + (boom ? p.boom_mass : 0.0);
  // Gravity pulls both alike and drops out of the relative motion.
  return (p.centre_mass * push + ring * centre_drag) / (ring + p.centre_mass);
}

LumpedState LumpedModel::startState(common::Mode mode, const Trial& trial, bool* held) const {
  if (mode == common::Mode::UNKNOWN) throw common::Error("lumped model: the start mode is unknown; allowed: F or Q");
  const LoadedBasins basins(*potential_);
  LumpedState state;
  state.thrust = trial.initial_thrust_fraction.value_or(idle_fraction_) * parameters_.max_thrust;
  if (trial.mount != Mount::HELD) state.ring_speed = state.centre_speed = trial.initial_speed;
  const bool exists = basins.equilibrium(mode, relativeLoad(state, trial), &state.travel);
  if (!exists) {
    const Equilibria& equilibria = potential_->equilibria();
    state.travel = mode == common::Mode::FIXED_WING ? equilibria.first : equilibria.second;
  }
  if (held) *held = exists;
  return state;
}

SnapPrediction LumpedModel::predict(common::Mode start, const common::Pulse& pulse, const common::Radio& radio,
                                    const Trial& trial, const LumpedObserver& observer) const {
  return predict(start, thrustFraction(radio, pulse.throttle), pulse.duration, trial, observer);
}

SnapPrediction LumpedModel::predict(common::Mode start, double fraction, double duration, const Trial& trial,
                                    const LumpedObserver& observer) const {
  trial.validate();
  require(fraction >= 0 && fraction <= 1, "thrust fraction", fraction, "0 .. 1");
  require(duration >= 0 && duration <= 60, "duration", duration, "0 .. 60 s");
  SnapPrediction out;
  LumpedState state = startState(start, trial, &out.start_held);
  out.start_mode = start;
  out.force_error = potential_->forceError();
  MarginWatch watch(*this, trial, start, state);
  if (observer) observer(state);

  const double begin = parameters_.latency, end = begin + duration;
  const double last_demand = trial.final_thrust_fraction.value_or(idle_fraction_);
  struct Segment {
    double until, demand;
  };
  const std::array<Segment, 3> segments = {{{begin, trial.initial_thrust_fraction.value_or(idle_fraction_)},
                                            {end, fraction},
                                            {end + trial.horizon, last_demand}}};
  bool settled = false, stopped = false;
  for (const Segment& segment : segments) {
    const double length = segment.until - state.time;
    if (!(length > 0)) continue;
    const int count = std::max(1, static_cast<int>(std::ceil(length / settings_.step - 1e-9)));
    const double dt = length / count;
    const double from = state.time;
    const bool final_segment = &segment == &segments.back();
    for (int i = 0; i < count && !settled && !stopped; ++i) {
      state = step(state, segment.demand, dt, trial);
      state.time = i + 1 == count ? segment.until : from + (i + 1) * dt;
      watch.add(state);
      ++out.steps;
      stopped = observer && !observer(state);
      // Looking takes about as long as a few steps, so not at each.
      if (final_segment && (i % 16 == 15 || i + 1 == count)) settled = watch.settled(segment.demand);
    }
    if (stopped) break;
  }
  if (settled) out.settle_time = state.time;
  watch.finish(settled, &out);
  return out;
}

}  // namespace snapwing::rom
