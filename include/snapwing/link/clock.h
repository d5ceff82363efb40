#pragma once
/// The computer's clocks. The bridge's own time is monotonic: stepping the wall clock does not touch it.

#include <cstdint>

namespace snapwing::link {

/// [s] CLOCK_MONOTONIC
double monotonicSeconds();
/// [us] since 1970; for logs only
std::int64_t wallMicroseconds();
/// Random number from the system, never 0.
std::int64_t randomId();

/// All clocks at one moment [s].
struct ClockReading {
  double monotonic = 0;
  double boottime = 0;  ///< advances while the computer is suspended
  double wall = 0;
};
ClockReading readClocks();

}  // namespace snapwing::link
