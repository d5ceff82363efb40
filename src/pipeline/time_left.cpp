#include "snapwing/pipeline/time_left.h"

#include <cmath>

namespace snapwing::pipeline {

namespace {
constexpr double AT_ONCE = 0.05;  // [s] between calls: found, not computed
}

double TimeLeft::after(double share, double now) {
  if (std::isnan(share)) return std::nan("");
  if (share_ < 0 || share < share_ || (first_share_ == share_ && share > share_ && now - last_ < AT_ONCE)) {
    first_share_ = share, first_ = now;
  }
  share_ = share, last_ = now;
  if (!(share > first_share_)) return std::nan("");
  return (1 - share) * (now - first_) / (share - first_share_);
}

}  // namespace snapwing::pipeline
