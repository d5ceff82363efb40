#pragma once
/// Follows the equilibria of a problem while one control (the travel of a driven port), or the place on a line of
/// several, goes from value to value.

#include <functional>
#include <string>
#include <vector>

#include "snapwing/solver/equilibrium.h"
#include "snapwing/statics/predictor.h"
#include "snapwing/statics/singular.h"

namespace snapwing::statics {

struct PathSettings {
  solver::NewtonSettings newton;
  solver::ControlLine line;     ///< of the controls; may be left out if there is exactly one
  double smallest_step = 1e-3;  ///< [1] share of a wanted step below which the path is given up, in (0, 1]
  bool keep_solutions = true;   ///< store z of every point
  /// Called after each wanted point with its number; returns true to stop.
  std::function<bool(int point)> progress;
  /// Told every point that is recorded.
  std::function<void(const struct PathPoint& point)> recorded;
  /// A step that releases energy (snaps to another branch) counts as failed.
  bool refuse_jumps = false;
  /// A stable equilibrium that another run found at exactly this control, or null. It is taken for the next point where
  /// this path leads to it: a way back need not find again what the way there found.
  std::function<const struct PathPoint*(double control)> known;
  bool locate_singular = true;  ///< where the number of negative pivots changes
  /// Leaves the primary branch at bifurcations, by this largest motion along the mode [m]; 0: stays on it.
  double perturbation = 0;
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
  int factorizations = 0;    ///< same
  bool restart = false;      ///< what follows does not depend on what came before
  bool by_arc = false;       ///< found by arc length, not at a wanted control
  Eigen::VectorXd solution;  ///< z
  Eigen::VectorXd slope;     ///< dz/d(control) along the path; kept and left out with the solution
  Eigen::VectorXd multipliers;
};

struct PathResult {
  solver::SolveStatus status = solver::SolveStatus::NOT_SOLVED;
  std::string message;            ///< on failure: where and why
  std::vector<PathPoint> points;  ///< those that were reached
  std::vector<SingularPoint> singular;
  std::vector<std::string> account;  ///< what was tried where, beside plain steps
  int iterations = 0, factorizations = 0, projections = 0, halvings = 0;
  double seconds = 0, seconds_assembly = 0, seconds_factor = 0, seconds_solve = 0, seconds_analysis = 0;
};

/// What a path or an arc reports of a linearised point.
PathPoint describePoint(const solver::Equilibrium& x, int iterations, int factorizations, bool keep_solution);

/// Steps from point to point with a Hermite predictor; a step that fails is halved.
class PathFollower {
 public:
  /// @throws common::Error for a line that does not fit its controls
  PathFollower(const solver::Problem& problem, PathSettings settings);

  /// @param start     free coordinates near equilibrium at targets[0]
  /// @param targets   control values in the order of the path, at least one
  PathResult follow(const Eigen::VectorXd& start, const std::vector<double>& targets);
  /// Goes on from a linearised point, which is not recorded again. It and every tenth wanted point are restart points.
  /// @param trail  recorded points before and at the start, in their order, for the first guesses
  PathResult followFrom(const solver::Equilibrium& start, const std::vector<double>& targets,
                        const std::vector<PathPoint>& trail = {});

  solver::EquilibriumSolver& solver() { return solver_; }
  /// Where the last path ended.
  const solver::Equilibrium& place() const { return place_; }

 private:
  bool begin(const Eigen::VectorXd& start, double control, solver::NewtonResult& last);
  void followTargets(const std::vector<double>& targets, std::size_t first, solver::NewtonResult& last);
  bool record(int point, int iterations, int factorizations, bool restart);
  void stopped(double target, const solver::NewtonResult& last);
  void restart();
  bool stepTo(double target, solver::NewtonResult& last);
  solver::NewtonResult arrive(solver::Equilibrium& next);
  bool takeKnown(solver::Equilibrium& next);
  void refine(bool has_factor);
  bool jumped(const solver::Equilibrium& next) const;
  void passSingular(const solver::Equilibrium& next, solver::Equilibrium& onward);
  PathResult finish(double begin);

  PathSettings settings_;
  solver::EquilibriumSolver solver_;
  Predictor predictor_;
  std::vector<PathPoint> trail_;  ///< the last recorded points: all that a resumed run knows
  solver::Equilibrium place_;
  Eigen::VectorXd refined_;  ///< solution at the place, better than the tolerance asks for
  PathResult result_;
  int factorizations_before_ = 0;
};

}  // namespace snapwing::statics
