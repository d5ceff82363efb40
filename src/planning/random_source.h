#pragma once
/// Random numbers that are the same with every standard library, unlike std::uniform_real_distribution's.

#include <cmath>
#include <cstdint>
#include <random>

#include "snapwing/common/uniform.h"

namespace snapwing::planning {

class RandomSource {
 public:
  explicit RandomSource(std::uint64_t seed) : engine_(seed) {}
  /// [0, 1)
  double uniform() { return common::uniform(engine_); }
  /// Standard normal, Box-Muller; both numbers of a pair are used.
  double normal() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    constexpr double TWO_PI = 6.283185307179586;
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    const double angle = TWO_PI * uniform();
    spare_ = radius * std::sin(angle);
    has_spare_ = true;
    return radius * std::cos(angle);
  }

 private:
  std::mt19937_64 engine_;
  double spare_ = 0;
  bool has_spare_ = false;
};

}  // namespace snapwing::planning
