#pragma once
/// Follows the equilibria of a problem while one control (the travel of a driven port) goes from value to value.

#include <functional>
#include <string>
#include <vector>

#include "snapwing/statics/newton.h"

namespace snapwing::statics {

struct PathSettings {
  NewtonSettings newton;
  double smallest_step = 1e-3;  ///< [1] share of a wanted step below which the path is given up, in (0, 1]
  bool keep_solutions = true;   ///< store z of every point
  /// Called after each wanted point with its number; returns true to stop.
  std::function<bool(int point)> progress;
};

struct PathPoint {
  double control = 0;       ///< [m] (or load factor)
  double energy = 0;        ///< elastic energy [J]
  double force = 0;         ///< dPi/dp [N]: what holds the control
  double stiffness = 0;     ///< d2Pi/dp2 along the path [N/m]
  bool stable = false;      ///< the Hessian of the free coordinates has a Cholesky factor
  int negative_pivots = 0;  ///< of the free Hessian; -1 unknown
  double min_det_f = 1;
  int iterations = 0;        ///< with those of intermediate steps
  Eigen::VectorXd solution;  ///< z
};

struct PathResult {
  SolveStatus status = SolveStatus::NOT_SOLVED;
  std::string message;            ///< on failure: where and why
  std::vector<PathPoint> points;  ///< those that were reached
  int iterations = 0, factorizations = 0, projections = 0, halvings = 0;
  double seconds = 0, seconds_assembly = 0, seconds_factor = 0, seconds_solve = 0, seconds_analysis = 0;
};

/// Steps from point to point with a tangent predictor; a step that fails is halved.
class PathFollower {
 public:
  /// @param problem  with exactly one control; must outlive this
  PathFollower(const Problem& problem, PathSettings settings);

  /// @param start     free coordinates near equilibrium at targets[0]
  /// @param targets   control values in the order of the path, at least one
  PathResult follow(const Eigen::VectorXd& start, const std::vector<double>& targets);

 private:
  struct Place;
  bool stepTo(double target, Place& place, PathResult& result, NewtonResult& last);
  void settle(Place& place);
  bool supported(const Place& place, NewtonResult& last);
  PathPoint describe(const Place& place, int iterations) const;

  const Problem& problem_;
  PathSettings settings_;
  Newton newton_;
};

}  // namespace snapwing::statics
