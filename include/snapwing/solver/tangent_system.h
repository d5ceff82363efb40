#pragma once
/// Linear systems with the matrix [H A^T; A 0] at one point, A = C J the rows of the constraints there (H only, without
/// constraints). H contains rho A^T A, which is zero on admissible motions, A z = 0. The number of negative pivots on
/// admissible motions is that of H less that of the Schur complement S = A H^-1 A^T.

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <memory>
#include <string>
#include <vector>

#include "snapwing/common/loan.h"
#include "snapwing/solver/problem.h"

namespace snapwing::solver {

class TangentSystem : public common::Lender {
 public:
  TangentSystem(const Problem& problem, Cholesky& cholesky) : problem_(problem), cholesky_(cholesky) {}
  /// Factorises if H is positive definite. @param hessian  [N/m] in the problem's pattern
  /// @param rows  A, of the constraints at the point; null without
  /// @return false if H has no Cholesky factor, or S is singular
  bool factorizeDefinite(const std::vector<double>& hessian, std::shared_ptr<const ConstraintRows> rows);
  /// Factorises H of any inertia. @param at  of order TANGENT
  /// @return number of negative pivots on admissible motions, -1 if singular
  int factorize(const Evaluation& at);
  /// Solves H z + A^T lambda = f, A z = g with the current factor. `lambda` is empty without constraints; with
  /// redundant ones it has no component along them (least norm).
  /// @param f  (free x 1) [N]; @param g  (constraints x 1) [m]; @param z  [m]; @param lambda  [N]
  void solve(const Eigen::VectorXd& f, const Eigen::VectorXd& g, Eigen::VectorXd& z, Eigen::VectorXd& lambda) const;
  /// Likewise for several right-hand sides, one a column.
  void solve(const Eigen::MatrixXd& f, const Eigen::MatrixXd& g, Eigen::MatrixXd& z, Eigen::MatrixXd& lambda) const;
  /// Names the rows that depend on each other at the last point tried, beyond those that do so everywhere, e.g. "dead
  /// point: 'pin a', 'pin b' hold the same motion there"; empty if there are none.
  std::string deadPoint() const;

 private:
  int formSchur();
  template <class Dense>
  void solveAny(const Dense& f, const Dense& g, Dense& z, Dense& lambda) const;

  common::Loan<const Problem> problem_;
  common::Loan<Cholesky> cholesky_;
  std::shared_ptr<const ConstraintRows> rows_;
  Eigen::MatrixXd spread_;  ///< H^-1 A^T
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> schur_;
  Eigen::VectorXd divisors_;  ///< eigenvalues of S, infinite for redundant rows
};

}  // namespace snapwing::solver
