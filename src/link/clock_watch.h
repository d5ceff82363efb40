#pragma once
/// Compares the computer's clocks with each other: a jump between them means that time passed which the loop's own
/// clock did not see (suspended, virtual machine paused), or that somebody set the time.

#include "snapwing/link/clock.h"

namespace snapwing::link {

class ClockWatch {
 public:
  static constexpr double LIMIT = 0.01;       ///< [s] boot time against monotonic: they differ by suspends alone
  static constexpr double WALL_LIMIT = 0.02;  ///< [s] wall clock against boot time, beyond what slewing may do
  static constexpr double SLEW = 0.1;         ///< wall clock may run fast or slow by so much

  /// @return [s] the largest jump since the last look, 0 if there was none
  double look(const ClockReading& now);

 private:
  bool first_ = true;
  double boottime_ = 0, boot_offset_ = 0, wall_offset_ = 0;
};

}  // namespace snapwing::link
