
#pragma once
/// Time in lanes: each vehicle has its own steps and its own moment in the pulse. Private to the layer.

#include "ensemble_motion.h"

namespace snapwing::rom::SNAPWING_WIDTH {

constexpr double SLOW = 0.01;  // [s] by which an error of the travel counts as one of its rate

constexpr double ACCURACY = 0.1;    // [m/s2] error of a step over the largest step
constexpr double VAGUE = 1.0 / 16;  // of the largest step: up to here a step may be vague
constexpr double LEAST = 1.0 / 64;  // of the largest step: the shortest

class Clock {
 public:
  Real wanted, lag_inverse;  ///< of the thrust: where it goes [N], 1 / its time constant

  /// @param now  gets the first demand's rate of the load
  Clock(const EnsembleScene& scene, const Vehicles& a, Instant* now)
      : wanted(now->thrust), lag_inverse(1.0), s_(scene), step_(scene.step), left_(0.0), part_(-1.0) {
    enter(a, ~none(), now);
  }

  Real thrustRate(const Real& thrust) const { return (wanted - thrust) * lag_inverse; }

  /// Length of the step to try; the last two before a demand changes are equal.
  Real next() {
    length_ = select(step_ >= left_, left_, select(2.0 * step_ > left_, 0.5 * left_, step_));
    return length_;
  }

  /// Lanes that may take the step. @param error  of RungeKutta; vague: of Watch
  Mask judge(const Real& error, const Mask& vague) {
    const double tolerance = ACCURACY * s_.step;
    const Mask bad = ~(error <= tolerance) | (vague & (length_ > VAGUE * s_.step));
    const Mask again = bad & (length_ > LEAST * s_.step);
    const Real faster = least(1.5 * step_, Real(s_.step)), slower = 0.7 * length_;
    const Real kept = select(error < 0.12 * tolerance, faster, select(error > 0.6 * tolerance, slower, step_));
    step_ = select(again, 0.5 * length_, kept);
    return ~again;
  }

  /// After a step: the time that is left, and the next demand where none is.
  void advance(const Vehicles& a, const Mask& taken, Instant* now) {
    left_ = select(taken, left_ - length_, left_);
    const Mask ended = taken & (left_ <= 0.0) & (part_ < LAST);
    if (any(ended)) enter(a, ended, now);
  }

  Real left() const { return left_; }  ///< [s] of this part
  Mask inLastPart() const { return part_ == LAST; }
  Mask over() const { return (part_ == LAST) & (left_ <= 0.0); }

 private:
  static constexpr double LAST = 3;  ///< before the pulse, during it, in its hold, and after

  __attribute__((noinline)) void enter(const Vehicles& a, Mask ended, Instant* now) {
    const Real before = thrustRate(now->thrust);
    const Mask changed = ended;
    while (any(ended)) {
      part_ = select(ended, part_ + 1.0, part_);
      const auto ofPart = [&](const Real& first, const Real& second, const Real& third, const Real& fourth) {
        return select(part_ < 1.0, first, select(part_ < 2.0, second, select(part_ < LAST, third, fourth)));
      };
      wanted = select(ended, ofPart(a.before, a.during, a.hold, a.after) * a.max_thrust, wanted);
      left_ = select(ended, ofPart(a.latency, a.duration, a.hold_duration, Real(s_.horizon)), left_);
      ended = ended & (left_ <= 0.0) & (part_ < LAST);
    }
    lag_inverse = select(changed, 1.0 / select(wanted > now->thrust, a.time_up, a.time_down), lag_inverse);
    const Real gain = select(changed, thrustRate(now->thrust) - before, Real(0.0)) * a.all_inverse;
    now->load_rate.force = now->load_rate.force + a.centre_mass * gain;
    now->load_rate.specific = now->load_rate.specific + gain;
  }

  const EnsembleScene& s_;
  Real step_, left_, part_;
  Real length_;
};

}  // namespace snapwing::rom::SNAPWING_WIDTH
