#pragma once
/// The strain that the arm's design limits and a trial reports.

#include <algorithm>
#include <cmath>

namespace snapwing::mpm {

/// max(0, sqrt(rho) (s - 1)) [1]. The factor sqrt(rho) reduces the strain of nearly empty cells.
/// @param density  rho of a cell [0, 1]; @param stretch  s, the largest principal one at its centre
inline double weightedStrain(double density, double stretch) { return std::sqrt(density) * std::max(0.0, stretch - 1); }

}  // namespace snapwing::mpm
