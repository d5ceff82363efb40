#pragma once
/// The machine's monotonic clock: stepping the wall clock does not touch it.

#include <cstdint>

namespace snapwing::link {

/// [s] CLOCK_MONOTONIC
double monotonicSeconds();
/// [us] since 1970; for logs only
std::int64_t wallMicroseconds();
/// Random number from the system, never 0.
std::int64_t randomId();

}  // namespace snapwing::link
