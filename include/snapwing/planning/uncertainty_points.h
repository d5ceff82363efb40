#pragma once
/// Deterministic points of the uncertainty box [-1, 1]^n.

#include <vector>

namespace snapwing::planning {

using BoxPoint = std::vector<double>;

/// `count` points of the Sobol sequence, from index `first` on: disjoint ranges give fresh points.
std::vector<BoxPoint> sobolPoints(int dimension, int count, int first);

/// Both ends of each coordinate, the others 0: 2 n points, low end first.
std::vector<BoxPoint> axisPoints(int dimension);

/// Every corner of the chosen coordinates, the others 0: 2^m points.
std::vector<BoxPoint> cornerPoints(int dimension, const std::vector<int>& coordinates);

}  // namespace snapwing::planning
