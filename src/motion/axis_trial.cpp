#include "snapwing/motion/axis_trial.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "snapwing/common/bisection.h"
#include "snapwing/common/error.h"
#include "snapwing/common/require.h"
#include "snapwing/vehicle/rotor_lag.h"

namespace snapwing::motion {

namespace {

constexpr double SLOW = 0.06, CALM = 0.12;  // [m/s], [s]: docs/motion.md
constexpr double SHARE_OF_BARRIER = 0.66;   // of the travel, in F
constexpr double SHARE_OF_VALLEY = 0.8;     // of the force, in Q
constexpr double FED = 0.1;                 // of the lower barrier's energy: beyond it the end mode says nothing
constexpr double STEADY = 0.01;             // of the full thrust

/// Cubic through travel and rate at both ends of a step.
struct Cubic {
  double from, h, u0, v0, u1, v1;
  double at(double t) const {
    const double s = 1 - t;
    return s * s * (1 + 2 * t) * u0 + t * t * (3 - 2 * t) * u1 + h * t * s * (s * v0 - t * v1);
  }
  double crossing(double level) const {
    return from + h * common::bisect([&](double t) { return at(t) - level; }, 0.0, 1.0, 60);
  }
  /// Largest and smallest within the step.
  std::pair<double, double> range() const {
    double low = std::min(u0, u1), high = std::max(u0, u1);
    if (v0 * v1 >= 0) return {low, high};
    for (int i = 1; i < 32; ++i) {
      low = std::min(low, at(i / 32.0));
      high = std::max(high, at(i / 32.0));
    }
    return {low, high};
  }
};

}  // namespace

ThrustHistory::ThrustHistory(double initial, double time_up, double time_down) : up_(time_up), down_(time_down) {
  if (!(time_up > 0) || !(time_down > 0)) throw common::Error("rotor time constants must be > 0");
  pieces_.push_back({-std::numeric_limits<double>::infinity(), initial, initial});
}

void ThrustHistory::demand(double time, double wanted) {
  if (time < pieces_.back().time) throw common::Error("demands of thrust must be in the order of time");
  pieces_.push_back({time, wanted, at(time)});
}

const ThrustHistory::Piece& ThrustHistory::pieceAt(double time) const {
  std::size_t k = pieces_.size() - 1;
  while (k > 0 && pieces_[k].time > time) --k;
  return pieces_[k];
}

double ThrustHistory::at(double time) const {
  const Piece& piece = pieceAt(time);
  if (!(time > piece.time) || std::isinf(piece.time)) return piece.thrust;
  return vehicle::laggedThrust(piece.thrust, piece.wanted, up_, down_, time - piece.time).end;
}

double ThrustHistory::mean(double from, double until) const {
  return vehicle::laggedThrust(at(from), pieceAt(from).wanted, up_, down_, until - from).mean;
}

AxisTrial AxisTrial::of(vehicle::Mode start, double fraction, double duration,
                        const vehicle::VehicleParameters& parameters, double idle, const vehicle::Trial& trial) {
  common::Require("trial").within("thrust fraction", fraction, 0, 1);
  common::Require("trial").within("duration", duration, 0, 60);
  AxisTrial out;
  out.start = start;
  out.fraction = fraction;
  out.duration = duration;
  out.initial_fraction = trial.initial_thrust_fraction.value_or(idle);
  out.final_fraction = trial.final_thrust_fraction.value_or(idle);
  out.latency = parameters.latency;
  out.max_thrust = parameters.max_thrust;
  out.time_up = parameters.time_constant_up;
  out.time_down = parameters.time_constant_down;
  out.horizon = trial.horizon;
  return out;
}

std::vector<double> AxisTrial::changes() const {
  std::vector<double> out = {latency, latency + duration};
  for (const vehicle::ThrustLevel& level : then) out.push_back(out.back() + level.duration);
  return out;
}

namespace {

/// What the trial asks of the motors.
ThrustHistory historyOf(const AxisTrial& trial, const std::vector<double>& changes) {
  ThrustHistory out(trial.initial_fraction * trial.max_thrust, trial.time_up, trial.time_down);
  out.demand(changes[0], trial.fraction * trial.max_thrust);
  for (std::size_t k = 0; k < trial.then.size(); ++k) {
    out.demand(changes[k + 1], trial.then[k].fraction * trial.max_thrust);
  }
  out.demand(changes.back(), trial.final_fraction * trial.max_thrust);
  return out;
}

/// A run and what it is judged by.
class Watch {
 public:
  Watch(const TrialVehicle& vehicle, const Stepper& stepper, const AxisTrial& trial, const ThrustHistory& thrust)
      : vehicle_(vehicle), stepper_(stepper), trial_(trial), thrust_(thrust) {
    last_change_ = trial.changes().back();
    barrier_ = vehicle.lowerBarrier();
  }

  AxisSample sample(const MotionState& s) const {
    AxisSample out = vehicle_.sample(s);
    out.thrust = thrust_.at(s.time);
    out.relative_kinetic = vehicle_.relativeKinetic(s, stepper_);
    return out;
  }

  void add(const StepAccount& account, AxisRun& run) const {
    const AxisSample& before = run.samples.back();
    AxisSample now = sample(run.state);
    now.ring_position = onward(before.ring_position, now.ring_position, vehicle_.turnLength());
    const double whole = 1 / vehicle_.shareOfVehicle();
    now.work = before.work + whole * account.work;
    now.loss = before.loss + whole * account.loss;
    now.imbalance = before.imbalance + whole * account.imbalance;
    now.step = account.h;
    now.min_det_f = account.min_det_f;
    now.iterations = account.iterations;
    AxisOutcome& out = run.outcome;
    const Cubic cubic{before.time, account.h, before.travel, before.travel_rate, now.travel, now.travel_rate};
    const double barrier = vehicle_.curve().barrier();
    if ((before.travel < barrier) != (now.travel < barrier)) out.snap_time = cubic.crossing(barrier);
    const auto [low, high] = cubic.range();
    out.least_travel = std::min(out.least_travel, low);
    out.peak_travel = std::max(out.peak_travel, high);
    out.peak_speed = std::max(out.peak_speed, std::abs(now.ring_speed));
    out.largest_imbalance = std::max(out.largest_imbalance, std::abs(now.imbalance));
    out.largest_strain = std::max(out.largest_strain, now.strain);
    out.largest_mean_strain = std::max(out.largest_mean_strain, now.mean_strain);
    ++out.steps;
    out.iterations += account.iterations;
    out.factorizations += account.factorizations;
    const double idle = trial_.final_fraction * trial_.max_thrust;
    if (std::abs(now.travel_rate) > SLOW || std::abs(now.thrust - idle) > STEADY * trial_.max_thrust) {
      run.calm_since = now.time;
    }
    run.samples.push_back(now);
    requireAccountClosed(run);
  }

  /// A scheme that keeps energy and does not: what it fed or ate may have decided the end mode. Schemes that damp are
  /// chosen to eat. @throws AccountError
  void requireAccountClosed(const AxisRun& run) const {
    const double off = run.outcome.largest_imbalance;
    if (stepper_.scheme().order() < 2 || !(off > FED * barrier_)) return;
    char words[300];
    std::snprintf(
        words, sizeof words,
        "the motion failed at %.4g s: until then the scheme added or removed %.3g mJ, more than %g %% of the lower "
        "barrier (%.3g mJ), so that "
        "the end mode would say nothing; take smaller steps (time: step, now up to %g s)",
        run.state.time, 1e3 * off, 100 * FED, 1e3 * barrier_, run.samples.back().step);
    throw AccountError(words);
  }

  /// Mode in which the travel has come to rest, if it has.
  vehicle::Mode restsIn(const AxisRun& run) const {
    const AxisSample& now = run.samples.back();
    if (now.time - std::max(run.calm_since, last_change_) < CALM) return vehicle::Mode::UNKNOWN;
    const StaticCurve& curve = vehicle_.curve();
    if (now.travel < SHARE_OF_BARRIER * curve.barrier()) return vehicle::Mode::FIXED_WING;
    const bool holds = now.travel > curve.valley() && curve.forceAt(now.travel) > SHARE_OF_VALLEY * curve.valleyForce();
    return holds ? vehicle::Mode::QUADROTOR : vehicle::Mode::UNKNOWN;
  }

  void finish(AxisRun& run, vehicle::Mode mode) const {
    AxisOutcome& out = run.outcome;
    out.end_mode = mode;
    out.snapped = mode != vehicle::Mode::UNKNOWN && mode != out.start_mode;
    out.end_travel = run.samples.back().travel;
    out.end_speed = vehicle_.commonSpeed(run.state, stepper_);
    if (mode != vehicle::Mode::UNKNOWN) out.settle_time = run.samples.back().time;
  }

 private:
  const TrialVehicle& vehicle_;
  const Stepper& stepper_;
  const AxisTrial& trial_;
  const ThrustHistory& thrust_;
  double last_change_ = 0;  ///< [s] of what is asked of the motors
  double barrier_ = 0;      ///< [J] the lower one; NaN of an arm that is not bistable
};

void begin(const TrialVehicle& vehicle, const AxisTrial& trial, const Watch& watch, AxisRun& run) {
  run = AxisRun{};
  run.begun = true;
  run.outcome.start_mode = trial.start;
  run.state = vehicle.start(trial.start, trial.initial_fraction * trial.max_thrust, &run.outcome.start_held);
  run.samples.push_back(watch.sample(run.state));
  run.outcome.least_travel = run.outcome.peak_travel = run.samples.back().travel;
  run.outcome.peak_speed = std::abs(run.samples.back().ring_speed);
  run.outcome.largest_strain = run.samples.back().strain;
  run.outcome.largest_mean_strain = run.samples.back().mean_strain;
}

}  // namespace

bool runTrial(const TrialVehicle& vehicle, Stepper& stepper, const AxisTrial& trial, AxisRun& run,
              const AxisRunHooks& hooks) {
  const std::vector<double> changes = trial.changes();
  const double last = changes.back() + trial.horizon;
  const ThrustHistory thrust = historyOf(trial, changes);
  const Watch watch(vehicle, stepper, trial, thrust);
  if (!run.begun) begin(vehicle, trial, watch, run);
  const ControlOf control = [&](double from, double h) {
    return vehicle.controls(from, h, thrust.mean(from, from + h));
  };
  stepper.restart();
  while (run.state.time < last) {
    const auto next = std::upper_bound(changes.begin(), changes.end(), run.state.time);
    watch.add(stepper.step(run.state, next == changes.end() ? last : *next, control), run);
    const vehicle::Mode rests = watch.restsIn(run);
    if (rests != vehicle::Mode::UNKNOWN) {
      watch.finish(run, rests);
      return true;
    }
    if (hooks.keep_every > 0 && run.outcome.steps % hooks.keep_every == 0) {
      // A resumed run has no factor either.
      stepper.restart();
      if (hooks.keep) hooks.keep(run);
    }
    if (hooks.stepped && !hooks.stepped(run)) return false;
  }
  watch.finish(run, vehicle::Mode::UNKNOWN);
  return true;
}

}  // namespace snapwing::motion
