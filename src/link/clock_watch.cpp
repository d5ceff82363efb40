#include "clock_watch.h"

#include <algorithm>
#include <cmath>

namespace snapwing::link {

double ClockWatch::look(const ClockReading& now) {
  const double boot_offset = now.boottime - now.monotonic, wall_offset = now.wall - now.boottime;
  if (first_) {
    boot_offset_ = boot_offset;
    wall_offset_ = wall_offset;
  }
  first_ = false;
  const double slewed = SLEW * std::max(0.0, now.boottime - boottime_);
  boottime_ = now.boottime;
  wall_offset_ += std::clamp(wall_offset - wall_offset_, -slewed, slewed);
  double jump = 0;
  if (std::abs(boot_offset - boot_offset_) > LIMIT) {
    jump = std::abs(boot_offset - boot_offset_);
    boot_offset_ = boot_offset;
  }
  if (std::abs(wall_offset - wall_offset_) > WALL_LIMIT) {
    jump = std::max(jump, std::abs(wall_offset - wall_offset_));
    wall_offset_ = wall_offset;
  }
  return jump;
}

}  // namespace snapwing::link
