#include "margin_watch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "snapwing/common/bisection.h"

namespace snapwing::rom {

namespace {

/// Travel within a step as the cubic through both ends' travel and rate; s in [0, 1].
struct StepCubic {
  double u0, w0, u1, w1, dt;
  StepCubic(const LumpedState& a, const LumpedState& b)
      : u0(a.travel), w0(a.travelRate()), u1(b.travel), w1(b.travelRate()), dt(b.time - a.time) {}
  double travel(double s) const {
    const double r = 1.0 - s;
    return r * r * (1.0 + 2.0 * s) * u0 + s * r * r * dt * w0 + s * s * (3.0 - 2.0 * s) * u1 - s * s * r * dt * w1;
  }
  double rate(double s) const {
    const double r = 1.0 - s;
    return 6.0 * s * r * (u1 - u0) / dt + r * (1.0 - 3.0 * s) * w0 + s * (3.0 * s - 2.0) * w1;
  }
};

/// Zero of a function that changes sign on [0, 1], to rounding of the step's share.
template <typename Function>
double zeroOfShare(const Function& function) {
  return common::bisect(function, 0.0, 1.0, 52);
}

constexpr double LARGEST_MARGIN = 10.0;
constexpr double NONE = std::numeric_limits<double>::quiet_NaN();

}  // namespace

MarginWatch::MarginWatch(const LumpedModel& model, const vehicle::Trial& trial, vehicle::Mode start,
                         const LumpedState& first)
    : model_(model),
      trial_(trial),
      equilibria_(model.potential().equilibria()),
      basins_(model.potential(), model.inertiaOf(trial)),
      target_(vehicle::otherMode(start)),
      last_(first),
      last_load_(model.relativeLoad(first, trial)),
      last_barrier_(basins_.barrierUnder(last_load_)),
      side_(last_barrier_.sideOf(first.travel)),
      peak_(first.travel),
      least_(first.travel),
      peak_speed_(std::abs(first.ring_speed)),
      crossing_time_(NONE),
      entry_(INFINITY),
      hold_(INFINITY),
      earlier_distance_(-INFINITY),
      last_distance_(-INFINITY) {}

double MarginWatch::barrierOf(vehicle::Mode side) const {
  return side == vehicle::Mode::FIXED_WING ? equilibria_.barrier_first : equilibria_.barrier_second;
}

double MarginWatch::kinetic(double travel, double rate) const {
  return 0.5 * model_.relativeMass(trial_, travel) * rate * rate;
}

void MarginWatch::enter(vehicle::Mode side, double travel, double relative_rate, const RelativeLoad& load) {
  // Without a barrier under this load, what the load has left over counts along the falling branch.
  side_ = side;
  entry_ = (kinetic(travel, relative_rate) + basins_.barrierUnder(load).excess) / barrierOf(vehicle::otherMode(side));
  hold_ = INFINITY;
  earlier_distance_ = last_distance_ = -INFINITY;
}

void MarginWatch::approach(double distance) {
  double rest = 0;
  // Only on the flank between the basin's bottom and its barrier: elsewhere the load has just made or moved the basin,
  // and its energy at this place says nothing about leaving it.
  if (last_distance_ <= earlier_distance_ && last_distance_ < distance && last_barrier_.exists &&
      basins_.equilibrium(side_, last_load_, &rest) &&
      (last_.travel - rest) * (last_barrier_.travel - last_.travel) >= 0) {
    hold_ = std::min(hold_, basins_.clearance(side_, last_.travel, 0.0, last_load_) / barrierOf(side_));
  }
  earlier_distance_ = last_distance_;
  last_distance_ = distance;
}

void MarginWatch::add(const LumpedState& next) {
  const RelativeLoad load = model_.relativeLoad(next, trial_);
  const StepCubic cubic(last_, next);
  const auto load_at = [&](double s) {
    return RelativeLoad{last_load_.force + s * (load.force - last_load_.force),
                        last_load_.specific_force + s * (load.specific_force - last_load_.specific_force)};
  };
  if ((last_.travel < equilibria_.barrier) != (next.travel < equilibria_.barrier)) {
    const double s = zeroOfShare([&](double share) { return cubic.travel(share) - equilibria_.barrier; });
    crossing_time_ = last_.time + s * cubic.dt;
  }
  if ((cubic.w0 < 0) != (cubic.w1 < 0) && cubic.w0 != 0) {
    const double turning = cubic.travel(zeroOfShare([&](double s) { return cubic.rate(s); }));
    peak_ = std::max(peak_, turning);
    least_ = std::min(least_, turning);
  }
  const LoadedBarrier barrier = basins_.barrierUnder(load, last_barrier_.travel);
  const vehicle::Mode side = barrier.sideOf(next.travel);
  if (side != side_) {
    const double at = zeroOfShare([&](double s) {
      return basins_.barrierUnder(load_at(s)).sideOf(cubic.travel(s)) == vehicle::Mode::FIXED_WING ? -1.0 : 1.0;
    });
    const double barrier_rate = (barrier.travel - last_barrier_.travel) / cubic.dt;
    enter(side, cubic.travel(at), cubic.rate(at) - barrier_rate, load_at(at));
  }
  approach(std::abs(next.travel - barrier.travel));
  peak_ = std::max(peak_, next.travel);
  least_ = std::min(least_, next.travel);
  peak_speed_ = std::max(peak_speed_, std::abs(next.ring_speed));
  last_ = next;
  last_load_ = load;
  last_barrier_ = barrier;
}

bool MarginWatch::settled(double demand) const {
  const double full = model_.parameters().max_thrust;
  if (std::abs(last_.thrust - demand * full) > 1e-3 * full) return false;
  const vehicle::Mode side = side_;
  double rest = 0;
  if (!basins_.equilibrium(side, last_load_, &rest)) return false;
  const double excess = kinetic(last_.travel, last_.travelRate()) + basins_.loadedEnergy(last_.travel, last_load_) -
                        basins_.loadedEnergy(rest, last_load_);
  const double small =
      model_.settings().settled_share * std::min(equilibria_.barrier_first, equilibria_.barrier_second);
  // Slow is not calm: a basin that the load has made shallow holds little.
  if (excess > std::min(small, 0.25 * basins_.clearance(side, rest, 0.0, last_load_))) return false;
  // The load moves monotonically from the present one to that of the terminal speed: if the basin holds at both ends,
  // it holds in between.
  LumpedState terminal = last_;
  terminal.thrust = demand * full;
  if (trial_.mount != vehicle::Mount::HELD) {
    const vehicle::VehicleParameters& p = model_.parameters();
    const bool boom = trial_.mount == vehicle::Mount::BOOM;
    const double mass = p.ring_mass + p.centre_mass + (boom ? p.boom_mass : 0.0);
    const double drag = p.ring_drag + p.centre_drag + (boom ? p.boom_drag : 0.0);
    const double push = terminal.thrust - mass * trial_.gravity;
    const double speed = drag > 0 ? std::copysign(std::sqrt(std::abs(push) / drag), push) : last_.centre_speed;
    terminal.ring_speed = terminal.centre_speed = speed;
  }
  double end = 0;
  return basins_.equilibrium(side, model_.relativeLoad(terminal, trial_), &end);
}

void MarginWatch::finish(bool settled, SnapPrediction* out) const {
  out->end_mode = settled ? side_ : vehicle::Mode::UNKNOWN;
  out->snapped = settled && side_ == target_;
  out->snap_time = crossing_time_;
  out->peak_travel = peak_;
  out->least_travel = least_;
  out->peak_speed = peak_speed_;
  out->end_travel = last_.travel;
  out->end_speed = model_.commonSpeed(last_, trial_);
  out->out_of_table = !model_.potential().inTable(peak_) || !model_.potential().inTable(least_);

  if (!settled) {
    out->energy_margin = -1.0;
    return;
  }
  const double moving = kinetic(last_.travel, last_.travelRate());
  const double here = basins_.clearance(side_, last_.travel, moving, last_load_) / barrierOf(side_);
  const double distance = std::clamp(std::min({entry_, hold_, here}), 0.0, LARGEST_MARGIN);
  out->energy_margin = side_ == target_ ? distance : -distance;
}

}  // namespace snapwing::rom
