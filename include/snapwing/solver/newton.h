#pragma once
/// Newton's method on the potential of a problem, with the exact tangent, projection on demand and a line search.
///
/// Converged: |r| <= max(relative_tolerance * force_scale, roundings * rounding, forceFloor()). A step d solves
/// H d = -r with the exact H. If H has no Cholesky factor, it is projected to be positive semidefinite at each
/// particle. Steps are halved until every det F > 0 and the potential decreases (Armijo; near the solution the
/// approximate Wolfe conditions [Hager and Zhang 2005]). Where the residual is not the gradient of a potential
/// (Evaluation::potential), an indefinite H is used without projection, and |r| must decrease.

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
  LINE_SEARCH_FAILED,  ///< no step along the direction decreases the potential
  SINGULAR,            ///< even the projected Hessian has no factor: a body is not supported
  CANCELLED,
  JUMPED,  ///< the equilibrium found lies on another branch
};
std::string statusName(SolveStatus status);

enum class Projection {
  ON_DEMAND,  ///< exact tangent, projected only where it has no Cholesky factor
  ALWAYS,     ///< negative eigenvalues always set to zero (the paper): for comparison
  ABSOLUTE,   ///< eigenvalues always replaced by their magnitudes: for comparison
};
/// @param name  on_demand, clamp or absolute. @throws common::Error
Projection projectionFromName(const std::string& name);
/// Order of evaluation for the projected Hessian.
inline Order projectedOrder(Projection projection) {
  return projection == Projection::ABSOLUTE ? Order::ABSOLUTE : Order::PROJECTED;
}

struct NewtonSettings {
  int max_iterations = 60;           ///< [1] >= 1
  double relative_tolerance = 1e-9;  ///< [1] in (0, 1e-2]
  double roundings = 10;             ///< [1] >= 1: tolerance in units of Evaluation::rounding
  Projection projection = Projection::ON_DEMAND;
  /// Reuses the factor of an earlier solve while each iteration reduces the residual enough, and assembles no tangent
  /// meanwhile: for time steps, whose Hessians change by little but the solids' rotation. The factor is turned with
  /// them (Problem::nodeRotations). The criterion of convergence is the same.
  bool keep_factor = false;
  /// Called before each iteration; true stops.
  std::function<bool()> cancelled;
  /// @throws common::Error naming the field
  void validate() const;
};

/// Tolerance on |r| [N] at an evaluation.
double residualTolerance(const Problem& problem, const Evaluation& at, const NewtonSettings& settings);

struct NewtonResult {
  SolveStatus status = SolveStatus::NOT_SOLVED;
  std::string message;                                         ///< what failed and where
  int iterations = 0;                                          ///< linear systems solved
  int factorizations = 0;                                      ///< of Cholesky, failed ones included
  int inner_iterations = 0;                                    ///< of conjugate gradients with an earlier factor
  int projections = 0;                                         ///< iterations with the projected Hessian
  double residual = std::numeric_limits<double>::quiet_NaN();  ///< |r| [N]
  bool converged() const { return status == SolveStatus::CONVERGED; }
};

/// Keeps the factor's symbolic part; one object per problem and thread.
class Newton {
 public:
  Newton(const Problem& problem, NewtonSettings settings);

  /// Solves dPi/dz = 0 at fixed controls and multipliers. On success `at` is the evaluation at z, of order TANGENT, or
  /// STRESS with keep_factor.
  /// @param p  (controls x 1)
  /// @param z  in: first guess; out: solution if converged, else the last iterate, (free x 1) [m]
  /// @param multipliers  of the problem's constraints [N], constant; empty without constraints
  /// @throws common::Error for a wrong number of multipliers
  NewtonResult solve(const Eigen::VectorXd& p, Eigen::VectorXd& z, Evaluation& at,
                     const Eigen::VectorXd& multipliers = Eigen::VectorXd());

  /// Halves the step d [m] until it is accepted, moves z and evaluates there (order as of solve()).
  /// @return false if no step is accepted
  bool lineSearch(const Eigen::VectorXd& p, const Eigen::VectorXd& multipliers, const Eigen::VectorXd& d,
                  Eigen::VectorXd& z, Evaluation& at);

  /// Discards the history of earlier solves: the next solve depends only on its input and on the current factor.
  void forget() {
    patience_ = 0;
    old_factor_serves_ = true;
    factor_is_recent_ = false;
    turns_.clear();
  }

  /// Discards the factor as well: the next solve is that of a new object.
  void restart() {
    forget();
    cholesky_.drop();
  }

  Cholesky& cholesky() { return cholesky_; }
  double secondsAssembly() const { return seconds_assembly_; }  ///< [s]

 private:
  /// Constant during a solve.
  struct Held {
    const Eigen::VectorXd &p, &multipliers;
  };
  void evaluate(const Eigen::VectorXd& z, const Held& held, Order order, Evaluation& at);
  bool nearby(const Evaluation& at, Eigen::VectorXd& d, NewtonResult& result);
  bool direction(const Eigen::VectorXd& z, const Held& held, Evaluation& at, Eigen::VectorXd& d, NewtonResult& result);
  double tolerance(const Evaluation& at) const;
  Eigen::VectorXd turnedSolve(const Eigen::VectorXd& b) const;
  Eigen::VectorXd alongFactor(const Eigen::VectorXd& residual) const;
  void learn(const Eigen::VectorXd& step, const Eigen::VectorXd& change);

  common::Loan<const Problem> problem_;
  NewtonSettings settings_;
  Cholesky cholesky_;
  Evaluation trial_;
  std::vector<NodeRotation> factor_rotations_;  ///< where the factor was made; with keep_factor
  struct Secant {
    Eigen::VectorXd step, change;  ///< of z [m], of the residual [N]
    double product;                ///< of both [J], > 0
  };
  std::vector<Secant> secants_;      ///< since the factor or the solve began, oldest first; with keep_factor
  std::vector<NodeRotation> turns_;  ///< from there to this solve's first guess; empty: none
  int patience_ = 0;                 ///< factorisations to wait before an old factor is tried again
  bool old_factor_serves_ = true;
  bool factor_is_recent_ = false;  ///< of an iterate of the current solve
  bool along_ = false;             ///< the next step reuses the factor
  double seconds_assembly_ = 0;
};

}  // namespace snapwing::solver
