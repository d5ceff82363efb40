#pragma once
/// Follows a branch to target values of the control: displacement control with step halving, arc length where it fails,
/// then displacement control again. Every change of method is reported (PathResult::account).

#include "snapwing/statics/arc_length.h"

namespace snapwing::statics {

struct AutomaticSettings {
  PathSettings path;           ///< refuse_jumps is also set if arc_on_failure is
  bool arc_on_failure = true;  ///< false: smaller steps only
  int largest_arc = 2000;      ///< points of one arc, >= 2
  double turn_back = 1;        ///< [1] an arc stops if it falls behind the start by this share of the path's length
};

/// @param start    first guess of the equilibrium at targets[0], (free x 1) [m]
/// @param targets  values of the control in the order of the path, at least two, monotone
/// @throws common::Error for less than two targets or settings out of range
PathResult followAutomatically(const solver::Problem& problem, const Eigen::VectorXd& start,
                               const std::vector<double>& targets, const AutomaticSettings& settings);
/// Resumes such a path from its last recorded restart point: the following points have the same bits as without the
/// interruption.
/// @param start   of the whole path
/// @param before  recorded points with solutions, at least one; the last must be a restart point at a target
PathResult continueAutomatically(const solver::Problem& problem, const Eigen::VectorXd& start,
                                 const std::vector<PathPoint>& before, const std::vector<double>& targets,
                                 const AutomaticSettings& settings);

/// Indices of the points at which the control reverses, and after which the number of negative pivots changes.
std::vector<int> turningPoints(const std::vector<PathPoint>& points);
std::vector<int> stabilityChanges(const std::vector<PathPoint>& points);

}  // namespace snapwing::statics
