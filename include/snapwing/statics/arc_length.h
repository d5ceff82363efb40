#pragma once
/// Follows a branch of equilibria by its arc length, through limit points of the control as well.
///
/// Unknowns (z, p) and the multipliers of constraints; corrector on the plane normal to the last direction t:
///   dL/dz (z, p) = 0,   w t_z.(z - z0) + t_p (p - p0) = ds,   w = 1 / |dz/dp|^2 at the start
/// solved by bordering: one factor of the exact Hessian per iteration, indefinite ones included.

#include "snapwing/statics/path.h"

namespace snapwing::statics {

struct ArcSettings {
  solver::NewtonSettings newton;  ///< iterations and tolerance; Newton here has no line search: steps are shortened
  double first_step = 0;          ///< [unit of the control] > 0
  double largest_step = 0;        ///< same; 0: ten times the first
  double smallest_step = 0;       ///< same; 0: 1e-6 of the first
  int max_points = 500;
  double weight = 0;          ///< w; 0: from the tangent at the start
  double end = 0;             ///< stops there, once the control passes it in the direction of the start
  double turn_back = -1e300;  ///< stops as well if the control falls below (in that direction)
  bool locate_singular = true;
  double perturbation = 0;                                  ///< as in PathSettings
  std::function<bool(int point, double control)> progress;  ///< true stops
  std::function<void(const PathPoint& point)> recorded;
};

struct ArcResult {
  PathResult path;                ///< points along the branch; the control need not be monotone
  std::vector<int> limit_points;  ///< numbers of points after which the control turned
  std::vector<int> crossings;     ///< after which the number of negative pivots changed: limit points or bifurcations
  solver::Equilibrium last;       ///< linearised; at `end` exactly if it was reached
};

/// @param start    free coordinates of an equilibrium at control p0
ArcResult followArc(const solver::Problem& problem, const Eigen::VectorXd& start, double p0,
                    const ArcSettings& settings);

/// The same from a linearised point of a solver, which is not recorded again.
ArcResult followArcFrom(solver::EquilibriumSolver& solver, const solver::Equilibrium& start,
                        const ArcSettings& settings);

}  // namespace snapwing::statics
