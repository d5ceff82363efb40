#include "snapwing/rom/lumped_model.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "margin_watch.h"
#include "resistance.h"
#include "snapwing/common/error.h"
#include "snapwing/common/require.h"

namespace snapwing::rom {

namespace {

const common::Require require("lumped model");

void validate(const vehicle::VehicleParameters& p) {
  require.positive("ring_mass", p.ring_mass);
  require.positive("centre_mass", p.centre_mass);
  require.positive("max_thrust", p.max_thrust);
  require.positive("time_constant_up", p.time_constant_up);
  require.positive("time_constant_down", p.time_constant_down);
  require(p.quadratic_share >= 0 && p.quadratic_share <= 1, "quadratic_share", p.quadratic_share, "0 .. 1");
  require.notNegative("damping", p.damping);
  require.notNegative("latency", p.latency);
  require.notNegative("ring_drag", p.ring_drag);
  require.notNegative("centre_drag", p.centre_drag);
  require.notNegative("boom_mass", p.boom_mass);
  require.notNegative("boom_drag", p.boom_drag);
  require.notNegative("boom_friction", p.boom_friction);
}

}  // namespace

void LumpedSettings::validate() const {
  require(step > 0 && step <= 0.01, "step", step, "above 0, up to 0.01 s");
  require(friction_speed > 0, "friction_speed", friction_speed, "above 0 m/s");
  require(settled_share > 0 && settled_share < 1, "settled_share", settled_share, "between 0 and 1");
  require(convergence > 0 && convergence <= 1e-3, "convergence", convergence, "above 0, up to 1e-3");
}

LumpedModel::LumpedModel(std::shared_ptr<const Potential> potential, const vehicle::VehicleParameters& parameters,
                         double idle_fraction, const LumpedSettings& settings,
                         std::shared_ptr<const TravelInertia> wing, std::shared_ptr<const TravelInertia> arms)
    : potential_(std::move(potential)),
      parameters_(parameters),
      idle_fraction_(idle_fraction),
      settings_(settings),
      arms_(std::move(arms)),
      winged_(arms_ && wing ? std::make_shared<const TravelInertia>(*arms_ + *wing) : std::move(wing)) {
  if (!potential_) throw common::Error("lumped model: no potential");
  validate(parameters_);
  settings_.validate();
  require(idle_fraction_ >= 0 && idle_fraction_ < 1, "idle_fraction", idle_fraction_, "0 .. below 1");
}

double LumpedModel::thrustFraction(const vehicle::Radio& radio, double throttle) const {
  return vehicle::thrustFraction(parameters_.quadratic_share, radio, throttle);
}

bool wingsAct(const vehicle::Trial& trial, bool has_wings) {
  if (trial.wings.value_or(false) && !has_wings) {
    throw common::Error("trial: wings are on, but the vehicle has none; allowed: a vehicle file with the key 'wing'");
  }
  return has_wings && trial.wings.value_or(trial.mount != vehicle::Mount::BOOM);
}

bool LumpedModel::wingsAct(const vehicle::Trial& trial) const { return rom::wingsAct(trial, winged_ != nullptr); }

const TravelInertia* LumpedModel::inertiaOf(const vehicle::Trial& trial) const {
  return wingsAct(trial) ? winged_.get() : arms_.get();
}

double LumpedModel::relativeMass(const vehicle::Trial& trial, double travel) const {
  const double centre = parameters_.centre_mass;
  const bool held = trial.mount == vehicle::Mount::HELD;
  const double ring = ringMass(trial);
  const TravelInertia* moved = inertiaOf(trial);
  if (!moved) return held ? centre : ring * centre / (ring + centre);
  return relativeInertia(moved->at(travel), centre, held ? INFINITY : ring + centre).mass;
}

double LumpedModel::relativeEnergy(const LumpedState& state, const vehicle::Trial& trial) const {
  const double rate = state.travelRate();
  return 0.5 * relativeMass(trial, state.travel) * rate * rate + potential_->energy(state.travel);
}

double LumpedModel::commonSpeed(const LumpedState& state, const vehicle::Trial& trial) const {
  if (trial.mount == vehicle::Mount::HELD) return state.ring_speed;
  const double ring = ringMass(trial), centre = parameters_.centre_mass;
  const TravelInertia* moved = inertiaOf(trial);
  const double coupled = moved ? moved->at(state.travel).coupled_mass * state.travelRate() : 0.0;
  return (ring * state.ring_speed + centre * state.centre_speed + coupled) / (ring + centre);
}

LumpedModel::RingResistance LumpedModel::ringResistance(double ring_speed, const vehicle::Trial& trial) const {
  const vehicle::VehicleParameters& p = parameters_;
  if (trial.mount != vehicle::Mount::BOOM) {
    const Resistance air = drag(p.ring_drag, ring_speed);
    return {air.force, air.slope};
  }
  const Resistance air = drag(p.ring_drag + p.boom_drag, ring_speed);
  const Resistance rub = coulomb(p.boom_friction, ring_speed, settings_.friction_speed);
  return {air.force + rub.force, air.slope + rub.slope};
}

RelativeLoad LumpedModel::relativeLoad(const LumpedState& state, const vehicle::Trial& trial) const {
  const double centre = parameters_.centre_mass;
  const double centre_drag = drag(parameters_.centre_drag, state.centre_speed).force;
  if (trial.mount == vehicle::Mount::HELD) return {centre * trial.gravity + centre_drag, trial.gravity};
  const double push = state.thrust + trial.push - ringResistance(state.ring_speed, trial).force;
  const double ring = ringMass(trial), all = ring + centre;
  // Gravity pulls all alike and drops out of the relative motion.
  return {(centre * push + ring * centre_drag) / all, (push - centre_drag) / all};
}

double LumpedModel::centreSpecificForce(const LumpedState& state, const vehicle::Trial& trial) const {
  const double centre = parameters_.centre_mass, w = state.travelRate();
  const double centre_drag = drag(parameters_.centre_drag, state.centre_speed).force;
  const double arms = potential_->at(state.travel).force + parameters_.damping * w;
  const TravelInertia* moved = inertiaOf(trial);
  if (!moved) return (arms - centre_drag) / centre;
  const InertiaSample s = moved->at(state.travel);
  const bool held = trial.mount == vehicle::Mount::HELD;
  const double all = held ? INFINITY : ringMass(trial) + centre;
  const RelativeInertia inertia = relativeInertia(s, centre, all);
  const RelativeLoad load = relativeLoad(state, trial);
  const double rub = coulomb(s.friction, w, settings_.friction_speed).force;
  const double relative =
      (load.force - load.specific_force * s.coupled_mass - arms - rub - 0.5 * inertia.mass_slope * w * w) /
      inertia.mass;
  if (held) return trial.gravity - relative;
  const double ring =
      load.specific_force + (inertia.lag * relative - s.coupled_slope * w * w) / all;  // its own specific force
  return ring - relative;
}

LumpedState LumpedModel::startState(vehicle::Mode mode, const vehicle::Trial& trial, bool* held) const {
  if (mode == vehicle::Mode::UNKNOWN) throw common::Error("lumped model: the start mode is unknown; allowed: F or Q");
  const LoadedBasins basins(*potential_, inertiaOf(trial));
  LumpedState state;
  state.thrust = trial.initial_thrust_fraction.value_or(idle_fraction_) * parameters_.max_thrust;
  if (trial.mount != vehicle::Mount::HELD) state.ring_speed = state.centre_speed = trial.initial_speed;
  const bool exists = basins.equilibrium(mode, relativeLoad(state, trial), &state.travel);
  if (!exists) {
    const Equilibria& equilibria = potential_->equilibria();
    state.travel = mode == vehicle::Mode::FIXED_WING ? equilibria.first : equilibria.second;
  }
  if (held) *held = exists;
  return state;
}

SnapPrediction LumpedModel::predict(vehicle::Mode start, const vehicle::Pulse& pulse, const vehicle::Radio& radio,
                                    const vehicle::Trial& trial, const LumpedObserver& observer) const {
  pulse.validateHold();
  const double hold = pulse.hold_duration > 0 ? thrustFraction(radio, pulse.hold_throttle) : 0.0;
  return predictLevels(start, {thrustFraction(radio, pulse.throttle), pulse.duration}, {hold, pulse.hold_duration},
                       trial, observer);
}

SnapPrediction LumpedModel::predict(vehicle::Mode start, double fraction, double duration, const vehicle::Trial& trial,
                                    const LumpedObserver& observer) const {
  return predictLevels(start, {fraction, duration}, {}, trial, observer);
}

namespace {
void requireLevel(const std::string& prefix, const vehicle::ThrustLevel& level) {
  require(level.fraction >= 0 && level.fraction <= 1, prefix + "thrust fraction", level.fraction, "0 .. 1");
  require(level.duration >= 0 && level.duration <= 60, prefix + "duration", level.duration, "0 .. 60 s");
}
}  // namespace

SnapPrediction LumpedModel::predictLevels(vehicle::Mode start, const vehicle::ThrustLevel& pulse,
                                          const vehicle::ThrustLevel& hold, const vehicle::Trial& trial,
                                          const LumpedObserver& observer) const {
  trial.validate();
  requireLevel("", pulse);
  requireLevel("hold ", hold);
  SnapPrediction out;
  LumpedState state = startState(start, trial, &out.start_held);
  out.start_mode = start;
  out.force_error = potential_->forceError();
  MarginWatch watch(*this, trial, start, state);
  if (observer) observer(state);

  const double begin = parameters_.latency, change = begin + pulse.duration, end = change + hold.duration;
  const double last_demand = trial.final_thrust_fraction.value_or(idle_fraction_);
  struct Segment {
    double until, demand;
  };
  const std::array<Segment, 4> segments = {{{begin, trial.initial_thrust_fraction.value_or(idle_fraction_)},
                                            {change, pulse.fraction},
                                            {end, hold.fraction},
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
