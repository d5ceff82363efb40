#pragma once
/// Peaks, valleys and zeros of the force along a traced branch, solved for instead of interpolated: the equilibrium
/// equations are solved again at every trial of the root finder.

#include <vector>

#include "snapwing/statics/path.h"

namespace snapwing::statics {

enum class FeatureKind { PEAK, VALLEY, ZERO };
std::string featureName(FeatureKind kind);

struct Feature {
  FeatureKind kind = FeatureKind::ZERO;
  int after = 0;         ///< number of the point that it follows
  PathPoint point;       ///< converged there; a zero is an equilibrium of what is not driven
  double accuracy = 0;   ///< width of the last bracket in the control
  double remainder = 0;  ///< at zeros |force| [N], else |d force / d control| there [N/m]
};

/// @param points  with their solutions, in the order of the branch; the control may turn
/// @param solver  of the same problem
std::vector<Feature> locateFeatures(EquilibriumSolver& solver, const std::vector<PathPoint>& points);

}  // namespace snapwing::statics
