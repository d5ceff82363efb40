#include "outside_force.h"

#include <algorithm>
#include <cmath>

namespace snapwing::planning {

namespace {
constexpr double PROPOSED_RATE = 5.0;  // [1/s] of touches among the particles that know none, at least
}

double OutsideForceProcess::move(OutsideForce* outside, double span, RandomSource& random) const {
  if (!acts()) return 1.0;
  if (outside->touched()) {
    if (random.uniform() < -std::expm1(-span / time_)) {
      *outside = {};
    } else {
      const double kept = std::exp(-span / time_);
      outside->force = kept * outside->force + outside->strength * std::sqrt(1.0 - kept * kept) * random.normal();
    }
    return 1.0;
  }
  const double real = -std::expm1(-rate_ * span);
  const double proposed = std::max(real, -std::expm1(-PROPOSED_RATE * span));
  if (random.uniform() >= proposed) return (1.0 - real) / (1.0 - proposed);
  outside->strength = strength_ * std::sqrt(-std::log(1.0 - random.uniform()));
  outside->force = outside->strength * random.normal();
  return real / proposed;
}

}  // namespace snapwing::planning
