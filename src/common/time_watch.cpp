#include "snapwing/common/time_watch.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "snapwing/common/require.h"

namespace snapwing::common {

namespace {

const Require require("time watch");

bool isTime(double value) { return std::isfinite(value) && value > 0; }

std::string words(const char* before, double seconds, const char* after) {
  char text[96];
  std::snprintf(text, sizeof text, "%s%.1f s%s", before, seconds, after);
  return text;
}

}  // namespace

ClockWatch::ClockWatch(double tolerance) : tolerance_(tolerance) { require.positive("tolerance", tolerance, " s"); }

ClockEvent ClockWatch::look(double now, double steady) {
  if (!isTime(now)) return ClockEvent::MISSING;
  const bool first = latest_ == 0;
  const double waited = std::max(0.0, steady - steady_);
  steady_ = steady;
  if (first || (now >= latest_ && now - latest_ <= waited + tolerance_)) {
    latest_ = now;
    return ClockEvent::ON;
  }
  if (now < latest_ && now >= latest_ - tolerance_) return ClockEvent::ON;  // a small correction: it stands for a while
  const ClockEvent event = now < latest_ ? ClockEvent::BACK : ClockEvent::AHEAD;
  latest_ = now;
  ++jumps_;
  return event;
}

StampWatch::StampWatch(const StampLimits& limits) : limits_(limits) {
  require.positive("stale", limits.stale, " s");
  require.positive("ahead", limits.ahead, " s");
}

StampVerdict StampWatch::take(double stamp, double now, double steady) {
  StampVerdict verdict = StampVerdict::GOOD;
  if (!isTime(now)) {
    verdict = StampVerdict::NO_CLOCK;
  } else if (!isTime(stamp)) {
    verdict = StampVerdict::UNSTAMPED;
  } else if (stamp > now + limits_.ahead) {
    verdict = StampVerdict::FUTURE;
  } else if (stamp < now - limits_.stale) {
    verdict = StampVerdict::STALE;
  } else if (stamp == last_) {
    verdict = StampVerdict::REPEATED;
  } else if (stamp < last_) {
    verdict = StampVerdict::OLDER;
  }
  ++counts_[static_cast<std::size_t>(verdict)];
  if (verdict == StampVerdict::GOOD) {
    last_ = stamp;
    came_ = steady;
  } else {
    refused_ = steady;
    reason_ = verdict;
    offset_ = stamp - now;
  }
  return verdict;
}

double StampWatch::age(double now, double steady) const {
  if (last_ == 0) return std::numeric_limits<double>::infinity();
  return std::max({0.0, steady - came_, now - last_});
}

void StampWatch::restart() {
  last_ = 0;
  came_ = refused_ = -std::numeric_limits<double>::infinity();
}

std::string StampWatch::trouble(double now, double steady, double oldest) const {
  if (!isTime(now)) return "cannot be judged: there is no clock yet";
  const double age_now = age(now, steady);
  if (age_now <= oldest) return "";
  if (steady - refused_ <= oldest) {
    if (reason_ == StampVerdict::FUTURE) return words("is stamped ", offset_, " ahead of the clock");
    if (reason_ == StampVerdict::STALE) return words("is stamped ", -offset_, " behind the clock");
    if (reason_ == StampVerdict::UNSTAMPED) return "carries no time stamp";
    if (reason_ != StampVerdict::NO_CLOCK) return "repeats old time stamps";
  }
  return std::isfinite(age_now) ? words("stopped ", age_now, " ago") : "never came";
}

}  // namespace snapwing::common
