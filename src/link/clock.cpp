#include "snapwing/link/clock.h"

#include <sodium.h>
#include <time.h>

namespace snapwing::link {

namespace {

double seconds(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

double monotonicSeconds() { return seconds(CLOCK_MONOTONIC); }

ClockReading readClocks() {
  ClockReading reading;
  // Taken off the processor between two of them, the clocks would seem to differ: then once more.
  for (int attempt = 0; attempt < 3; ++attempt) {
    reading = {seconds(CLOCK_MONOTONIC), seconds(CLOCK_BOOTTIME), seconds(CLOCK_REALTIME)};
    if (seconds(CLOCK_BOOTTIME) - reading.boottime < 0.001 && seconds(CLOCK_MONOTONIC) - reading.monotonic < 0.001)
      break;
  }
  return reading;
}

std::int64_t wallMicroseconds() {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return static_cast<std::int64_t>(now.tv_sec) * 1000000 + now.tv_nsec / 1000;
}

std::int64_t randomId() {
  std::int64_t id = 0;
  while (id == 0) randombytes_buf(&id, sizeof id);
  return id;
}

}  // namespace snapwing::link
