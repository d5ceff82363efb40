#pragma once
/// The strain that the arm's design limits and that a trial tells.

#include <algorithm>
#include <cmath>

namespace snapwing::mpm {

/// sqrt(rho) (s - 1), never negative: what is nearly empty does not count. [1]
/// @param density  rho of a cell [0, 1]; @param stretch  s, the largest principal one at its centre
inline double weightedStrain(double density, double stretch) { return std::sqrt(density) * std::max(0.0, stretch - 1); }

}  // namespace snapwing::mpm
