#pragma once
/// Follows a branch of equilibria by arc length, also through limit points of the control.
///
/// Unknowns: (z, p) and the multipliers of constraints. Corrector on the plane normal to the last direction t:
///   dL/dz (z, p) = 0,   w t_z.(z - z0) + t_p (p - p0) = ds,   w = 1 / |dz/dp|^2 at the start
/// solved by bordering: one factorisation of the exact Hessian per iteration, which may be indefinite. A step is halved
/// if the corrector fails, moves far from the tangent, or if the branch turns sharply.

#include "snapwing/statics/path.h"

namespace snapwing::statics {

struct ArcSettings {
  solver::NewtonSettings newton;  ///< tolerance; the corrector has no line search and its own limit of iterations
  double first_step = 0;          ///< [unit of the control] > 0
  double largest_step = 0;        ///< [unit of the control]; 0: ten times the first
  double smallest_step = 0;       ///< [unit of the control]; 0: 1e-6 of the first
  int max_points = 500;           ///< >= 2
  double weight = 0;              ///< w [(unit of the control / m)^2]; 0: from the tangent at the start
  double end = 0;                 ///< stops where the control reaches this value; the path starts towards it
  double turn_back = -1e300;      ///< stops if the control times the direction of the path (+-1) falls below this
  bool locate_singular = true;    ///< where the number of negative pivots changes
  double perturbation = 0;        ///< [m] as in PathSettings
  std::function<bool(int point, double control)> progress;  ///< called after each point; true stops
  std::function<void(const PathPoint& point)> recorded;     ///< called with each recorded point
};

struct ArcResult {
  PathResult path;                ///< points along the branch; the control need not be monotone
  std::vector<int> limit_points;  ///< indices of the points after which the control reversed; -1: after the start
  std::vector<int> crossings;     ///< likewise, where the number of negative pivots changed
  solver::Equilibrium last;       ///< linearised; at `end` exactly if it was reached
};

/// @param start    first guess of the equilibrium at control p0, (free x 1) [m]
/// @throws common::Error for settings out of range, or a problem without exactly one control
ArcResult followArc(const solver::Problem& problem, const Eigen::VectorXd& start, double p0,
                    const ArcSettings& settings);

/// Likewise from a linearised point, which is not recorded again. @throws common::Error for settings out of range
ArcResult followArcFrom(solver::EquilibriumSolver& solver, const solver::Equilibrium& start,
                        const ArcSettings& settings);

}  // namespace snapwing::statics
