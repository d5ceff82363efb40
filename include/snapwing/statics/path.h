#pragma once
/// Follows a branch of equilibria by displacement control: one control (the travel of a driven port, a load factor), or
/// the parameter of a line of controls, takes given values one after the other.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "snapwing/solver/equilibrium.h"
#include "snapwing/statics/branch_series.h"
#include "snapwing/statics/predictor.h"
#include "snapwing/statics/singular.h"

namespace snapwing::statics {

struct PathSettings {
  solver::NewtonSettings newton;
  solver::ControlLine line;     ///< of the controls; may be left out if there is exactly one
  double smallest_step = 1e-3;  ///< [1] in (0, 1]: share of the step to a target below which the path ends
  bool keep_solutions = true;   ///< store z, its slope and the multipliers of every point
  /// Called after each target with its index; true stops.
  std::function<bool(int point)> progress;
  /// Called with every recorded point.
  std::function<void(const struct PathPoint& point)> recorded;
  /// A step that releases energy (snaps to another branch) counts as failed.
  bool refuse_jumps = false;
  /// A stable equilibrium that another run found at exactly this control, or null. It becomes the next point if the
  /// guess of this path is near it: the way back reuses the solutions of the way there.
  std::function<const struct PathPoint*(double control)> known;
  bool series = false;          ///< power series where they cover several targets (BranchSeries)
  bool locate_singular = true;  ///< where the number of negative pivots changes
  /// [m] At a bifurcation of a stable branch the path continues on the other branch, starting with this largest entry
  /// of the motion along the mode; 0: it stays on the primary branch.
  double perturbation = 0;
};

struct PathPoint {
  double control = 0;           ///< [m] (or load factor)
  double energy = 0;            ///< elastic energy [J]
  double force = 0;             ///< dPi/dp [N]: force on the control (load factor: [J])
  double stiffness = 0;         ///< d(force)/dp along the path [N/m]
  bool stable = false;          ///< no negative pivots
  int negative_pivots = 0;      ///< of the Hessian on admissible motions; -1 unknown
  double min_det_f = 1;         ///< smallest over the particles [1]
  int iterations = 0;           ///< of Newton, intermediate steps included
  int factorizations = 0;       ///< likewise
  bool restart = false;         ///< restart point: the next points depend on this and the recorded ones only
  bool by_arc = false;          ///< found by arc length, not at a target
  bool by_series = false;       ///< between two stable points on one series, without a factor of its own
  Eigen::VectorXd solution;     ///< z [m]; empty without keep_solutions, as the next two
  Eigen::VectorXd slope;        ///< dz/dp along the path
  Eigen::VectorXd multipliers;  ///< of kept constraints [N]
};

struct PathResult {
  solver::SolveStatus status = solver::SolveStatus::NOT_SOLVED;
  std::string message;                  ///< on failure: where and why
  std::vector<PathPoint> points;        ///< the points reached
  std::vector<SingularPoint> singular;  ///< singular points located
  std::vector<std::string> account;     ///< changes of method and failed attempts, in words
  int iterations = 0, factorizations = 0, projections = 0, halvings = 0;
  int series = 0;         ///< power series that served
  std::string no_series;  ///< what has none, if something
  double seconds = 0, seconds_assembly = 0, seconds_factor = 0, seconds_solve = 0, seconds_analysis = 0;  ///< wall [s]
};

/// PathPoint of a linearised equilibrium.
PathPoint describePoint(const solver::Equilibrium& x, int iterations, int factorizations, bool keep_solution);

/// Displacement control with a Hermite predictor; a step that fails is halved.
class PathFollower {
 public:
  /// @param problem  lent. @throws common::Error for settings out of range, or a line of another number of controls
  PathFollower(const solver::Problem& problem, PathSettings settings);

  /// Fails with SINGULAR at the first target if a body is not supported.
  /// @param start     first guess of the equilibrium at targets[0], (free x 1) [m]
  /// @param targets   control values in the order of the path, at least one. @throws common::Error for none
  PathResult follow(const Eigen::VectorXd& start, const std::vector<double>& targets);
  /// Continues from a linearised point, which is not recorded again. It is a restart point, and so is every tenth
  /// target after one, or the last one that a series covers.
  /// @param trail  recorded points up to the start, in their order, for the predictor
  PathResult followFrom(const solver::Equilibrium& start, const std::vector<double>& targets,
                        const std::vector<PathPoint>& trail = {});

  solver::EquilibriumSolver& solver() { return solver_; }
  /// Last point of the last path.
  const solver::Equilibrium& place() const { return place_; }

 private:
  bool begin(const Eigen::VectorXd& start, double control, solver::NewtonResult& last);
  void followTargets(const std::vector<double>& targets, std::size_t first, solver::NewtonResult& last);
  bool record(int point, int iterations, int factorizations, bool restart);
  void stopped(double target, const solver::NewtonResult& last);
  bool restartDue(double target) const;
  void leaveSeries();
  void restart();
  void expand(const std::vector<double>& targets, std::size_t next);
  bool settle(solver::Equilibrium& next, solver::NewtonResult& result);
  void lookAhead(const std::vector<double>& targets, std::size_t next);
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
  std::unique_ptr<solver::ResidualSeries> forces_;  ///< of the problem; null: none, or not wanted
  std::unique_ptr<BranchSeries> series_;            ///< from the last restart on; null: none
  solver::Equilibrium ahead_;                       ///< on series_, linearised and stable; only where ahead_is_stable_
  bool ahead_is_stable_ = false;
  bool factor_is_ahead_ = false;  ///< the solver's, of ahead_ or of the place that it became
  bool ahead_is_last_ = false;    ///< of the targets that series_ covers
  Eigen::VectorXd series_slope_;  ///< dz/dp of series_ where it was asked last
  bool on_series_ = false;        ///< the place
  bool settled_ = false;          ///< and without a factor of its own
  int since_restart_ = 0;         ///< targets
  std::vector<PathPoint> trail_;  ///< the last recorded points: the only history of a resumed run
  solver::Equilibrium place_;
  Eigen::VectorXd refined_;  ///< solution at the place, more accurate than the tolerance requires
  PathResult result_;
  int factorizations_before_ = 0;
};

}  // namespace snapwing::statics
