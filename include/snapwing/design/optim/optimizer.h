#pragma once
/// Minimise f(x) subject to g_i(x) <= 0 and low <= x <= high, with derivatives: what an optimiser asks, may be asked
/// and answers. Values should be scaled so that f and g are of order 1 to 100.

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace snapwing::design {

/// One evaluation.
struct Evaluated {
  bool valid = false;  ///< false: the point cannot be evaluated; `message` says why
  std::string message;
  double objective = 0;         ///< f
  Eigen::VectorXd gradient;     ///< df/dx, (n x 1)
  Eigen::VectorXd constraints;  ///< g, (m x 1)
  Eigen::MatrixXd jacobian;     ///< dg/dx, (m x n)
};

class OptimizationProblem {
 public:
  virtual ~OptimizationProblem() = default;
  virtual int variableCount() const = 0;
  virtual int constraintCount() const = 0;
  virtual Eigen::VectorXd lower() const = 0;  ///< bound of x, (n x 1)
  virtual Eigen::VectorXd upper() const = 0;  ///< bound of x, (n x 1)
  /// @param with_derivatives  false: only values are wanted
  virtual Evaluated evaluate(const Eigen::VectorXd& x, bool with_derivatives) = 0;
  /// Told before iteration k = 0, 1 ...: continuation (bounds, sharpness) is set here and nowhere else.
  virtual void beginIteration(int /*k*/, int /*total*/) {}
};

enum class OptimizerStatus {
  NOT_RUN,
  CONVERGED,          ///< largest change of x below the tolerance and feasible
  ITERATION_LIMIT,    ///< ended at the given limit, feasible: at the last iterate, else at the latest such
  INFEASIBLE,         ///< ended with a constraint violated
  EVALUATION_FAILED,  ///< no shorter step could be evaluated
  CANCELLED,
};
std::string nameOf(OptimizerStatus status);
/// The status of a name; NOT_RUN for any other word.
OptimizerStatus optimizerStatusOf(const std::string& name);

struct OptimizerReport {
  int iteration = 0;
  double objective = 0;
  double violation = 0;  ///< max(0, max g)
  double change = 0;     ///< largest |x_new - x|
  double seconds = 0;    ///< since the start
  Eigen::VectorXd constraints;
};

/// State of an iteration, sufficient to resume bit for bit.
struct OptimizerState {
  int iteration = 0;
  Eigen::VectorXd x, x_old, x_older, low, high;  ///< with the moving asymptotes
  Eigen::VectorXd x_feasible;                    ///< latest that met all bounds once it might end; empty: none
};

struct OptimizerSettings {
  int iterations = 100;           ///< [1] >= 1
  double move = 0.05;             ///< largest change of a variable, as share of its range, in (0, 1]
  double tolerance = 1e-4;        ///< stop if nothing changes by more than this share of the range
  int least_iterations = 0;       ///< not converged before (continuation must have ended)
  double feasibility = 1e-3;      ///< g above it is a violation
  double penalty = 1000;          ///< c of the elastic constraints of a subproblem
  bool conservative = false;      ///< GCMMA: inner iterations until the approximation is above the truth
  double asymptote_start = 0.5;   ///< distance of the first asymptotes, share of the range
  double asymptote_shrink = 0.7;  ///< where x oscillates
  double asymptote_grow = 1.2;    ///< where x keeps its direction
  /// After each evaluation; true cancels.
  std::function<bool(const OptimizerReport&, const OptimizerState&)> progress;
  /// @throws common::Error naming the field
  void validate() const;
};

struct OptimizerResult {
  OptimizerStatus status = OptimizerStatus::NOT_RUN;
  std::string message;
  OptimizerState state;  ///< state.x is the answer
  double objective = 0, violation = 0;
  int evaluations = 0;
  double seconds = 0;
  std::vector<OptimizerReport> history;
};

class Optimizer {
 public:
  virtual ~Optimizer() = default;
  /// @param start  only x must be filled; the rest continues an earlier run
  virtual OptimizerResult run(OptimizationProblem& problem, const OptimizerState& start) const = 0;
};

/// Method of moving asymptotes (Svanberg 1987), or its globally convergent version (2002) if settings.conservative:
/// one evaluation with derivatives an iteration; the subproblem is solved in its dual by an interior-point Newton.
std::unique_ptr<Optimizer> makeMma(const OptimizerSettings& settings);
/// NLopt's LD_MMA (a conservative MMA without move limit), in stages of `stage_evaluations` within x +- move.
std::unique_ptr<Optimizer> makeNloptMma(const OptimizerSettings& settings, int stage_evaluations = 6);

}  // namespace snapwing::design
