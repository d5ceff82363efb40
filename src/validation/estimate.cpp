#include "snapwing/validation/estimate.h"

#include <algorithm>
#include <cmath>

namespace snapwing::validation {

namespace {

constexpr double DOUBT_OF_CORRECTION = 1.0 / 3;

}  // namespace

Estimate limitOfCells(double fine, double coarse, double ratio) {
  const double correction = (fine - coarse) / (ratio - 1);
  return {fine + correction, DOUBT_OF_CORRECTION * std::abs(correction)};
}

Estimate meanOf(const std::vector<Estimate>& limits) {
  if (limits.empty()) return {};
  double least = INFINITY, most = -INFINITY;
  Estimate mean{0, 0};
  for (const Estimate& limit : limits) {
    mean.value += limit.value / static_cast<double>(limits.size());
    mean.error = std::max(mean.error, limit.error);
    least = std::min(least, limit.value), most = std::max(most, limit.value);
  }
  mean.error = std::max(mean.error, 0.5 * (most - least));
  return mean;
}

}  // namespace snapwing::validation
