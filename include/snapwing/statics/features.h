#pragma once
/// Peaks, valleys and zeros of the force along a traced branch, located by solving the equilibrium equations, not by
/// interpolation.
///
/// Between two stable points of displacement control the branch is a function of the control p. The first guess is the
/// root of the cubic Hermite polynomial of the force. Then the equilibrium is solved at p, and p is corrected by
/// Newton's method with the tangent stiffness (zeros of F) or by the secant method (zeros of dF/dp), mostly with an
/// existing factor. On arcs, unstable branches and with kept constraints, or where p leaves the interval or the branch,
/// a bracketing root finder (TOMS 748) solves the equilibrium equations at shares of the chord.

#include <vector>

#include "snapwing/statics/path.h"

namespace snapwing::statics {

/// Extremes of the force in the direction away from control 0: for a path to negative travel a peak is a minimum. The
/// kind does not depend on the direction in which the path was followed.
enum class FeatureKind { PEAK, VALLEY, ZERO };
/// peak, valley or zero.
std::string featureName(FeatureKind kind);

struct Feature {
  FeatureKind kind = FeatureKind::ZERO;
  int after = 0;         ///< index of the point before it
  PathPoint point;       ///< converged there; a zero is an equilibrium without a force on the control
  double accuracy = 0;   ///< last correction, or width of the last bracket [unit of the control]
  double remainder = 0;  ///< at zeros |force| [N], else |d force / d control| there [N/m]
};

/// @param points  with their solutions, in the order of the branch; the control may reverse
/// @param solver  of the same problem
/// @param lost    if given: number of features that the signs at the points imply but that were not found
std::vector<Feature> locateFeatures(solver::EquilibriumSolver& solver, const std::vector<PathPoint>& points,
                                    int* lost = nullptr);

/// Features located with an own solver, and the cost.
struct LocatedFeatures {
  std::vector<Feature> found;
  bool complete = false;  ///< all features that the signs at the points imply were found
  int factorizations = 0;
  double seconds = 0;  ///< wall time [s]
};
/// @param newton  of the path; tried first with a hundredth of its relative tolerance
LocatedFeatures locateFeaturesOf(const solver::Problem& problem, const solver::NewtonSettings& newton,
                                 const std::vector<PathPoint>& points);

}  // namespace snapwing::statics
