#pragma once
/// Linear systems [H A^T; A 0] at one point, A = C J the rows of the constraints there (H alone without). H contains
/// rho A^T A, which changes nothing where A z = 0; its negative pivots on admissible motions are those of H less those
/// of the Schur complement S = A H^-1 A^T.

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
  /// @param rows  of the constraints at the point; null without
  /// @return true if positive definite on admissible motions
  bool factorizeDefinite(const std::vector<double>& hessian, std::shared_ptr<const ConstraintRows> rows);
  /// Of any inertia. @param at  of order TANGENT. @return negative pivots, -1 if singular
  int factorize(const Evaluation& at);
  /// Solves H z + A^T lambda = f, A z = g; `lambda` is empty without constraints, the shortest if some are redundant.
  void solve(const Eigen::VectorXd& f, const Eigen::VectorXd& g, Eigen::VectorXd& z, Eigen::VectorXd& lambda) const;
  /// The same for several right-hand sides, one a column.
  void solve(const Eigen::MatrixXd& f, const Eigen::MatrixXd& g, Eigen::MatrixXd& z, Eigen::MatrixXd& lambda) const;
  /// Names the rows that say the same at the last point tried, beside those that do so everywhere, e.g. "dead point:
  /// 'pin a', 'pin b' hold the same motion there"; empty if none do.
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
  Eigen::VectorXd divisors_;  ///< eigenvalues of S, infinite for what is redundant
};

}  // namespace snapwing::solver
