#pragma once
/// Newton's method on the potential of a problem, with the exact tangent, projection on demand and a line search.
///
/// Converged: |r| <= max(relative_tolerance * force_scale, 10 rounding, forceFloor()). A step d solves H d = -r with
/// the exact H; only if its Cholesky factor does not exist is the Hessian projected cell by cell to be positive. Steps
/// are shortened until the potential falls (Armijo) and every det F is above 0.

#include <functional>
#include <string>

#include "snapwing/common/loan.h"
#include "snapwing/solver/problem.h"

namespace snapwing::solver {

enum class SolveStatus {
  NOT_SOLVED,
  CONVERGED,
  ITERATION_LIMIT,
  INVERTED_START,      ///< the first guess inverts an element (det F <= 0)
  LINE_SEARCH_FAILED,  ///< no step along the direction lowers the potential
  SINGULAR,            ///< even the projected Hessian has no factor: something is not supported
  CANCELLED,
  JUMPED,  ///< the equilibrium that was found lies on another branch
};
std::string statusName(SolveStatus status);

enum class Projection {
  ON_DEMAND,  ///< exact tangent, projected only where it has no Cholesky factor
  ALWAYS,     ///< negative eigenvalues always set to zero (the paper): for comparison
  ABSOLUTE,   ///< eigenvalues always replaced by their magnitudes: for comparison
};
/// on_demand, clamp or absolute. @throws common::Error
Projection projectionFromName(const std::string& name);
/// What an iteration assembles when the exact tangent does not serve.
inline Order projectedOrder(Projection projection) {
  return projection == Projection::ABSOLUTE ? Order::ABSOLUTE : Order::PROJECTED;
}

struct NewtonSettings {
  int max_iterations = 60;           ///< [1] >= 1
  double relative_tolerance = 1e-9;  ///< [1] in (0, 1e-2]
  double roundings = 10;             ///< what rounding leaves of a force, times this, is no residual [1] >= 1
  Projection projection = Projection::ON_DEMAND;
  /// Steps go along with the factor of an earlier solve as long as each cuts the residual to a quarter, and assemble no
  /// tangent meanwhile: for steps in time, whose Hessians hardly change. What is converged is the same.
  bool keep_factor = false;
  /// Asked before each iteration; true stops.
  std::function<bool()> cancelled;
  /// @throws common::Error naming the field
  void validate() const;
};

/// What |r| [N] must come below at an evaluation.
double residualTolerance(const Problem& problem, const Evaluation& at, const NewtonSettings& settings);

struct NewtonResult {
  SolveStatus status = SolveStatus::NOT_SOLVED;
  std::string message;                                         ///< what failed and where
  int iterations = 0;                                          ///< linear systems solved
  int factorizations = 0;                                      ///< tries of Cholesky, failed ones too
  int inner_iterations = 0;                                    ///< of conjugate gradients with an earlier factor
  int projections = 0;                                         ///< iterations that needed the projected Hessian
  double residual = std::numeric_limits<double>::quiet_NaN();  ///< |r| [N]
  bool converged() const { return status == SolveStatus::CONVERGED; }
};

/// Keeps the factor's symbolic part; one object per problem and thread.
class Newton {
 public:
  Newton(const Problem& problem, NewtonSettings settings);

  /// @param p  controls
  /// @param z  in: first guess; out: solution if converged, else where it stopped
  /// @param multipliers  of the problem's constraints, held; empty without constraints
  /// On success `at` holds the evaluation of order TANGENT at z, with keep_factor of order STRESS.
  NewtonResult solve(const Eigen::VectorXd& p, Eigen::VectorXd& z, Evaluation& at,
                     const Eigen::VectorXd& multipliers = Eigen::VectorXd());

  /// Shortens the step d until the potential falls; moves z and evaluates there (order TANGENT). @return false if none
  /// does
  bool lineSearch(const Eigen::VectorXd& p, const Eigen::VectorXd& multipliers, const Eigen::VectorXd& d,
                  Eigen::VectorXd& z, Evaluation& at);

  /// Forgets how earlier solves went: what follows depends on the next point and on the factor held only.
  void forget() {
    patience_ = 0;
    old_factor_serves_ = true;
    factor_is_recent_ = false;
  }

  /// Forgets the factor as well: what follows is what a new object would do.
  void restart() {
    forget();
    cholesky_.drop();
  }

  Cholesky& cholesky() { return cholesky_; }
  double secondsAssembly() const { return seconds_assembly_; }  ///< [s]

 private:
  /// What stays as it is during a solve.
  struct Held {
    const Eigen::VectorXd &p, &multipliers;
  };
  void evaluate(const Eigen::VectorXd& z, const Held& held, Order order, Evaluation& at);
  bool nearby(const Evaluation& at, Eigen::VectorXd& d, NewtonResult& result);
  bool direction(const Eigen::VectorXd& z, const Held& held, Evaluation& at, Eigen::VectorXd& d, NewtonResult& result);
  double tolerance(const Evaluation& at) const;

  common::Loan<const Problem> problem_;
  NewtonSettings settings_;
  Cholesky cholesky_;
  Evaluation trial_;
  int patience_ = 0;  ///< factorizations to wait before an old factor is tried again
  bool old_factor_serves_ = true;
  bool factor_is_recent_ = false;  ///< of an iterate of the solve that runs
  bool along_ = false;             ///< the next step keeps the factor
  double seconds_assembly_ = 0;
};

}  // namespace snapwing::solver
