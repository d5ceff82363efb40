#pragma once
/// Peaks, valleys and zeros of the force along a traced branch, solved for instead of interpolated.
///
/// Between two stable points of displacement control the branch is a function of the control p. The cubic Hermite
/// polynomial of the force gives the first guess; then the equilibrium is solved at p and p is moved by Newton's method
/// with the tangent stiffness (zeros of F) or by the secant (zeros of dF/dp), mostly with the factor that is there.
/// Elsewhere (arcs, unstable branches, constraints kept as equations), or where that leaves the interval or the branch,
/// the equilibrium equations are solved at every trial of a bracketing root finder along the chord.

#include <vector>

#include "snapwing/statics/path.h"

namespace snapwing::statics {

/// Extremes of the force that is needed to go away from control 0: for a path to negative travel a peak is a minimum.
/// They do not depend on the direction in which the path was followed.
enum class FeatureKind { PEAK, VALLEY, ZERO };
std::string featureName(FeatureKind kind);

struct Feature {
  FeatureKind kind = FeatureKind::ZERO;
  int after = 0;         ///< number of the point that it follows
  PathPoint point;       ///< converged there; a zero is an equilibrium of what is not driven
  double accuracy = 0;   ///< last correction, or width of the last bracket, in the control
  double remainder = 0;  ///< at zeros |force| [N], else |d force / d control| there [N/m]
};

/// @param points  with their solutions, in the order of the branch; the control may turn
/// @param solver  of the same problem
/// @param lost    if given: number of features that are there by the signs at the points but were not found
std::vector<Feature> locateFeatures(solver::EquilibriumSolver& solver, const std::vector<PathPoint>& points,
                                    int* lost = nullptr);

/// The same with a solver of its own, and what it cost.
struct LocatedFeatures {
  std::vector<Feature> found;
  bool complete = false;  ///< all that the signs at the points promise
  int factorizations = 0;
  double seconds = 0;
};
LocatedFeatures locateFeaturesOf(const solver::Problem& problem, const solver::NewtonSettings& newton,
                                 const std::vector<PathPoint>& points);

}  // namespace snapwing::statics
