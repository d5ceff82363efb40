#pragma once
/// Uniform random numbers that are equal with every standard library, unlike the standard distributions.

#include <random>

namespace snapwing::common {

/// In [0, 1), from the engine's upper 53 bits.
inline double uniform(std::mt19937_64& engine) { return static_cast<double>(engine() >> 11) * 0x1.0p-53; }

/// In [-1, 1), by one draw.
inline double uniformAbout0(std::mt19937_64& engine) { return 2.0 * uniform(engine) - 1.0; }

}  // namespace snapwing::common
