#pragma once
/// Follows a branch to wanted controls whatever it does on the way: displacement control with smaller and smaller steps
/// first, arc length where these fail, displacement control again beyond. Every change of method is accounted for.

#include "snapwing/statics/arc_length.h"

namespace snapwing::statics {

struct AutomaticSettings {
  PathSettings path;           ///< jumps are refused if arcs may take over
  bool arc_on_failure = true;  ///< false: smaller steps only
  int largest_arc = 2000;      ///< points of one arc, >= 2
  double turn_back = 1;        ///< an arc that falls back behind the start by this share of the path gives up
};

/// @param targets  values of the control in the order of the path, at least two, monotone
PathResult followAutomatically(const solver::Problem& problem, const Eigen::VectorXd& start,
                               const std::vector<double>& targets, const AutomaticSettings& settings);
/// Goes on with such a path from the last of the points that it recorded, at a wanted control: those that follow have
/// the same bits as without the interruption.
/// @param start   where the whole path started
/// @param before  at least one point
PathResult continueAutomatically(const solver::Problem& problem, const Eigen::VectorXd& start,
                                 const std::vector<PathPoint>& before, const std::vector<double>& targets,
                                 const AutomaticSettings& settings);

/// Numbers of points after which the control turned, and after which the number of negative pivots changed.
std::vector<int> turningPoints(const std::vector<PathPoint>& points);
std::vector<int> stabilityChanges(const std::vector<PathPoint>& points);

}  // namespace snapwing::statics
