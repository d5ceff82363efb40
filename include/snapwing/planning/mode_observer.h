#pragma once
/// The mode estimate in time: puts readings and motor outputs in the order of their stamps, feeds the estimator, and
/// says UNKNOWN, with the reason, when nothing is known: no clock, no reading yet, readings that stopped, a clock that
/// jumped. No ROS, no clock of its own: `now` and `steady` as in common/time_watch.h.
///
/// | what happens                              | the estimate                                                   |
/// |-------------------------------------------|----------------------------------------------------------------|
/// | no clock, no reading yet                  | UNKNOWN; begins at the first reading, in the mode stated       |
/// | the motors turn before the first reading  | the stated mode is discarded                                   |
/// | no reading for `silence`                  | UNKNOWN until readings come back                               |
/// | no reading for the estimator's longest_gap| restarts at the next reading, no mode stated                   |
/// | readings at less than `least_rate`        | UNKNOWN while this lasts                                       |
/// | the clock jumps, back or ahead            | restarts at once, no mode stated                               |
/// | no link status for `link_timeout`         | the motors count as stopped: the flight controller's failsafe  |
/// | a burst of late readings                  | thinned to `burst_spacing`                                     |
/// | more than `hurry` waits                   | thinned to the estimator's correlation_time, in coarse steps   |
/// | more than `most_behind` waits             | what is older is skipped: a gap like any other                 |
/// | the same at two consecutive updates       | restarts with the last `hurry`, no mode stated                 |
/// A computer that is too slow makes the estimate coarse, then unsure, but never much older than its stamp.

#include <limits>
#include <map>

#include "snapwing/common/time_watch.h"
#include "snapwing/planning/mode_estimator.h"

namespace snapwing::planning {

struct ObserverSettings {
  double input_delay = 0.06;  ///< [s] 0 .. 0.5, inputs are put in order of their stamps within this time
  double link_timeout = 0.3;  ///< [s] 0.1 .. 5
  /// [s] 0 .. 0.2 from the link status that reports a frame sent until the motors' output follows, at the earliest; at
  /// the latest EstimatorSettings::output_delay more. The plan's radio latency is another time: it begins at the
  /// command.
  double frame_delay = 0.005;
  double silence = 0.25;        ///< [s] 0.05 .. 1
  double stale = 2.0;           ///< [s] 0.5 .. 10, readings that come later than this are not used
  double burst_spacing = 0.01;  ///< [s] of readings, where more than 16 wait
  double least_rate = 15.0;     ///< [Hz] 0 .. 200 of readings, below which the mode is UNKNOWN; 0 = any
  double hurry = 0.2;        ///< [s] 0.05 .. 2, of waiting readings from which they are worked through in coarse steps
  double most_behind = 0.6;  ///< [s] hurry .. 5, of waiting readings; older ones are skipped
  double idle_output = 0.1;  ///< [1] mean motor output above which the motors may have moved the vehicle
  vehicle::Mode stated = vehicle::Mode::UNKNOWN;  ///< what the operator sees at the start
  void validate() const;                          ///< @throws common::Error naming the member
};

/// The report at one moment.
struct ModeReport {
  bool fresh = false;     ///< the stamp is newer than that of the last fresh report: publish it only then
  double stamp = 0;       ///< [s] of the clock that messages are stamped by
  ModeEstimate estimate;  ///< mode UNKNOWN and the reason, if nothing is known
  /// [s] of the newest reading in it, at the stamp; NaN = none came
  double reading_age = std::numeric_limits<double>::quiet_NaN();
};

/// The mode to draw: the likelier one, and the one drawn before as long as the odds are nearly even.
vehicle::Mode shownMode(vehicle::Mode before, const ModeEstimate& estimate);

class ModeObserver {
 public:
  /// @throws common::Error for bad settings
  ModeObserver(ModeEstimator estimator, const ObserverSettings& settings);

  /// A reading of the accelerometer. @param specific_force  [m/s2]; NaN is not used
  void reading(double stamp, double specific_force, double now, double steady);
  /// Mean motor output [0, 1] that acts from `stamp` + `delay` on, as a link status reports it.
  void motors(double stamp, double output, double delay, double now, double steady);
  /// Somebody sees the mode now: restarts with it. UNKNOWN: restarts without information.
  void state(vehicle::Mode mode);
  /// Somebody sees the ring held still, or let go: until then the estimate's speeds are 0.
  void holdRing(bool held) { held_ = held; }

  ModeReport update(double now, double steady);

  const common::StampWatch& readings() const { return reading_watch_; }
  const common::StampWatch& links() const { return link_watch_; }
  unsigned jumps() const { return clock_.jumps(); }
  std::size_t waiting() const { return inputs_.size(); }
  /// [Hz] of the readings, over the last half second or so
  double readingRate() const { return rate_; }
  /// Readings that were not used because newer ones waited behind them.
  unsigned long skipped() const { return skipped_; }
  const ModeEstimator& estimator() const { return estimator_; }
  unsigned long notNumbers() const { return not_numbers_; }

 private:
  struct Input {
    bool motors;  ///< else a reading
    double value;
  };
  /// @return false while there is no clock
  bool lookAtClock(double now, double steady);
  void forget(const std::string& reason, vehicle::Mode stated);
  void begin(double stamp);
  void feed(double until);
  std::string tooSlow() const;
  double sinceOrigin(double stamp) const { return stamp - origin_; }

  ModeEstimator estimator_;
  ObserverSettings settings_;
  common::ClockWatch clock_;
  common::StampWatch reading_watch_, link_watch_;
  std::multimap<double, Input> inputs_;  ///< by the time from which they act
  vehicle::Mode stated_;
  std::string why_;  ///< why nothing is known since the last restart; empty: no reason
  bool begun_ = false;
  double origin_ = 0;  ///< stamp of the first reading: the estimator counts from there
  double newest_ = 0;  ///< stamp of the newest reading that was fed
  double motor_output_ = 0;
  double told_ = 0;      ///< stamp of the last fresh report
  bool behind_ = false;  ///< at the last feed more than `most_behind` waited
  bool held_ = false;
  double rate_ = 0;  ///< [Hz]
  unsigned long not_numbers_ = 0, skipped_ = 0;
};

}  // namespace snapwing::planning
