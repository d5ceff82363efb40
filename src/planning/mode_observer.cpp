#include "snapwing/planning/mode_observer.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "snapwing/common/require.h"

namespace snapwing::planning {

namespace {

using common::ClockEvent;
using common::StampVerdict;
using vehicle::Mode;

constexpr double RATE_TIME = 0.5;  // [s] over which the rate of the readings is taken
constexpr std::size_t BURST = 16;  // readings at once from which they are thinned
constexpr const char* FELL_BEHIND = "this computer fell behind the IMU readings, and nothing has shown the mode since";

const common::Require require("mode observer");

}  // namespace

void ObserverSettings::validate() const {
  require.within("input_delay", input_delay, 0.0, 0.5);
  require.within("link_timeout", link_timeout, 0.1, 5.0);
  require.within("frame_delay", frame_delay, 0.0, 0.2);
  require.within("silence", silence, 0.05, 1.0);
  require.within("stale", stale, 0.5, 10.0);
  require.within("burst_spacing", burst_spacing, 1e-3, 0.1);
  require.within("least_rate", least_rate, 0.0, 200.0);
  require.within("hurry", hurry, 0.05, 2.0);
  require.within("most_behind", most_behind, hurry, 5.0);
  require.within("idle_output", idle_output, 0.0, 1.0);
}

Mode shownMode(Mode before, const ModeEstimate& estimate) {
  constexpr double EVEN = 0.1;
  const bool even = std::abs(estimate.probability_quadrotor - estimate.probability_fixed_wing) < EVEN;
  return even && before != Mode::UNKNOWN ? before : estimate.likelier();
}

ModeObserver::ModeObserver(ModeEstimator estimator, const ObserverSettings& settings)
    : estimator_(std::move(estimator)),
      settings_((settings.validate(), settings)),
      reading_watch_({settings.stale, 0.25}),
      link_watch_({settings.stale, 0.25}),
      stated_(settings.stated) {
  estimator_.reset(0.0, Mode::UNKNOWN);
}

bool ModeObserver::lookAtClock(double now, double steady) {
  switch (clock_.look(now, steady)) {
    case ClockEvent::MISSING:
      return false;
    case ClockEvent::BACK:
      forget("the clock jumped back, and nothing has shown the mode since", Mode::UNKNOWN);
      return true;
    case ClockEvent::AHEAD:
      forget("the clock jumped ahead, and nothing has shown the mode since", Mode::UNKNOWN);
      return true;
    case ClockEvent::ON:
      break;
  }
  return true;
}

void ModeObserver::forget(const std::string& reason, Mode stated) {
  inputs_.clear();
  reading_watch_.restart();
  link_watch_.restart();
  estimator_.reset(0.0, Mode::UNKNOWN);
  begun_ = false;
  told_ = rate_ = 0;
  why_ = reason;
  stated_ = stated;
}

void ModeObserver::state(Mode mode) { forget(mode == Mode::UNKNOWN ? "no reading has shown the mode yet" : "", mode); }

void ModeObserver::reading(double stamp, double specific_force, double now, double steady) {
  if (!std::isfinite(specific_force)) {
    ++not_numbers_;
    return;
  }
  if (!lookAtClock(now, steady)) return;
  const double before = reading_watch_.last();
  if (reading_watch_.take(stamp, now, steady) != StampVerdict::GOOD) return;
  // Weighed by the time that it stands for, 1 / interval has the mean readings / time.
  const double interval = stamp - before;
  if (before > 0) rate_ += (1.0 / interval - rate_) * (rate_ > 0 ? -std::expm1(-interval / RATE_TIME) : 1.0);
  inputs_.emplace(stamp, Input{false, specific_force});
}

void ModeObserver::motors(double stamp, double output, double delay, double now, double steady) {
  if (!std::isfinite(output) || !lookAtClock(now, steady)) return;
  if (link_watch_.take(stamp, now, steady) != StampVerdict::GOOD) return;
  if (!begun_ && output > settings_.idle_output && stated_ != Mode::UNKNOWN) {
    stated_ = Mode::UNKNOWN;
    why_ = "the motors turned while no reading came";
  }
  inputs_.emplace(stamp + delay, Input{true, output});
}

void ModeObserver::begin(double stamp) {
  begun_ = true;
  origin_ = newest_ = stamp;
  estimator_.reset(0.0, stated_);
  estimator_.motorOutput(-1.0, motor_output_);
}

void ModeObserver::feed(double until) {
  const auto end = inputs_.upper_bound(until);
  const bool burst = std::distance(inputs_.begin(), end) > static_cast<std::ptrdiff_t>(BURST);
  const double longest_gap = estimator_.settings().longest_gap;
  double oldest = until - settings_.most_behind;
  // Behind once is a stall, and its gap is bridged. Behind twice on end, this computer is too slow for that.
  const bool behind = begun_ && newest_ < oldest, again = behind && behind_;
  if (again) {
    oldest = until - settings_.hurry;
    estimator_.reset(0.0, Mode::UNKNOWN);
    origin_ = oldest;
    estimator_.motorOutput(-100.0, motor_output_);
    why_ = FELL_BEHIND;
  }
  behind_ = again;
  const bool hurried = inputs_.begin() != end && inputs_.begin()->first < until - settings_.hurry;
  const double spacing = hurried ? estimator_.settings().correlation_time : burst ? settings_.burst_spacing : 0.0;
  const char* gap = "the IMU readings stopped, and nothing has shown the mode since";
  for (auto it = inputs_.begin(); it != end; ++it) {
    const auto& [when, input] = *it;
    if (input.motors) {
      motor_output_ = input.value;
      if (begun_) estimator_.motorOutput(sinceOrigin(when), input.value);
      continue;
    }
    if (when < oldest) {
      ++skipped_;
      gap = FELL_BEHIND;
      continue;
    }
    if (begun_ && when - newest_ < spacing) continue;
    if (!begun_) begin(when);
    if (when - newest_ > longest_gap) why_ = gap;
    newest_ = when;
    behind_ = behind;
    estimator_.accelerometer(sinceOrigin(when), input.value, hurried);
    if (held_) estimator_.atRest();
  }
  inputs_.erase(inputs_.begin(), end);
}

std::string ModeObserver::tooSlow() const {
  char text[96];
  std::snprintf(text, sizeof text, "the IMU is read %.0f times a second, %.0f are needed", rate_, settings_.least_rate);
  return text;
}

ModeReport ModeObserver::update(double now, double steady) {
  ModeReport report;
  if (!lookAtClock(now, steady)) {
    report.estimate.reason = "there is no clock yet";
    return report;
  }
  const double until = now - settings_.input_delay;
  feed(until);
  // A flight controller that hears nothing stops the motors: its failsafe.
  const double link_age = link_watch_.age(now, steady);
  if (std::isfinite(link_age) && link_age > settings_.link_timeout + settings_.input_delay) {
    motor_output_ = 0;
    if (begun_) estimator_.motorOutput(sinceOrigin(until), 0.0);
  }
  const double reading_age = reading_watch_.age(now, steady) - settings_.input_delay;
  const bool silent = reading_age > settings_.silence;
  report.estimate = estimator_.estimate();
  if (begun_) report.reading_age = silent ? reading_age : 0.0;
  if (!begun_ || silent) {
    report.estimate.mode = Mode::UNKNOWN;
    report.estimate.reason =
        "the IMU " + reading_watch_.trouble(now, steady, settings_.silence + settings_.input_delay);
    if (!silent) report.estimate.reason = "no IMU reading was in time so far";
    if (reading_age > estimator_.settings().longest_gap)
      report.estimate.probability_fixed_wing = report.estimate.probability_quadrotor = 0.5;
  } else if (rate_ < settings_.least_rate) {
    report.estimate.mode = Mode::UNKNOWN;
    report.estimate.reason = tooSlow();
  } else if (report.estimate.mode != Mode::UNKNOWN) {
    why_.clear();
  } else if (!why_.empty()) {
    report.estimate.reason = why_;
  }
  // While readings come, the estimate is as old as the newest of them.
  report.stamp = begun_ && !silent ? newest_ : until;
  report.fresh = report.stamp > told_;
  if (report.fresh) told_ = report.stamp;
  return report;
}

}  // namespace snapwing::planning
