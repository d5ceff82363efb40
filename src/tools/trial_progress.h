#pragma once
/// Where a trial in time is, twice a second on the terminal.

#include <chrono>
#include <cstdio>

#include "snapwing/motion/axis_trial.h"

namespace snapwing::tools {

class TrialProgress {
 public:
  /// @param last  time at which the trial ends at the latest [s]
  TrialProgress(bool quiet, double last) : quiet_(quiet), last_(last) {}
  /// @param time  of the state that the run begins or resumes with [s]
  void startsAt(double time) { from_ = time; }
  void show(const motion::AxisRun& run) {
    const auto now = Clock::now();
    if (quiet_ || now - shown_ <= std::chrono::milliseconds(500)) return;
    shown_ = now;
    const double seconds = std::chrono::duration<double>(now - begin_).count();
    const double done = run.state.time - from_;
    std::fprintf(stderr, "\r%.3f of at most %.3f s, travel %.1f mm, %.0f s left at most ", run.state.time, last_,
                 1e3 * run.samples.back().travel, done > 0 ? seconds * (last_ - run.state.time) / done : 0.0);
    std::fflush(stderr);
  }
  void end() const {
    if (!quiet_) std::fprintf(stderr, "\n");
  }

 private:
  using Clock = std::chrono::steady_clock;
  bool quiet_;
  double last_, from_ = 0;
  Clock::time_point begin_ = Clock::now(), shown_ = begin_;
};

}  // namespace snapwing::tools
