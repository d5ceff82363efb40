#pragma once
/// Symmetric indefinite systems of solids under constraints that are kept instead of eliminated:
///   [K  H^T; H  0] [x; y] = [f; g]
/// K: block matrix of a discretisation, singular by itself where a body is held by joints only. Adding w H^T times the
/// second row to the first does not change the solution and makes K_w = K + w H^T H positive definite wherever K is so
/// along the constraints and w is large enough, so that a sparse Cholesky factor and a small dense Schur complement
/// S = H K_w^-1 H^T do:   y = S^-1 (H K_w^-1 (f + w H^T g) - g),   x = K_w^-1 (f + w H^T g - H^T y).

#include <Eigen/Cholesky>
#include <Eigen/SparseCore>
#include <memory>
#include <string>
#include <vector>

#include "snapwing/mpm/block_matrix.h"
#include "snapwing/statics/sparse.h"

namespace snapwing::statics {

using ConstraintRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// How far the rows of H are from depending on each other.
struct RowRank {
  int rank = 0;               ///< singular values above `threshold` times the largest
  double smallest = 0;        ///< smallest singular value over the largest [1]
  std::vector<int> culprits;  ///< rows with a large share in the smallest one's left vector
};
RowRank rankOf(const ConstraintRows& H, double threshold = 1e-8);

template <int D>
class SaddlePoint {
 public:
  /// @param pattern  of K; H  rows over its dofs; weight  w > 0 [of K / H^2]
  SaddlePoint(const mpm::BlockPattern<D>& pattern, const ConstraintRows& H, double weight);

  /// @param blocks  values of K in the order of its pattern; shift  added to K's diagonal [of K], >= 0
  /// @return false if K_w is not positive definite; there is then no factor
  bool factorize(const std::vector<double>& blocks, double shift = 0);
  /// x and y for any number of right-hand sides (columns), with the last good factor.
  void solve(const Eigen::MatrixXd& f, const Eigen::MatrixXd& g, Eigen::MatrixXd* x, Eigen::MatrixXd* y) const;
  /// K_w^-1 f alone: the step of an augmented Lagrangian.
  Eigen::VectorXd solvePenalty(const Eigen::VectorXd& f) const { return cholesky_->solve(f); }

  const ConstraintRows& rows() const { return H_; }
  double weight() const { return weight_; }

 private:
  ConstraintRows H_;
  double weight_;
  std::vector<int> source_;   ///< per entry: number in `blocks`, -1: none
  std::vector<double> base_;  ///< w H^T H
  std::vector<int> diagonal_;
  SparsePattern pattern_;
  std::unique_ptr<Cholesky> cholesky_;
  Eigen::MatrixXd spread_;  ///< K_w^-1 H^T
  Eigen::LDLT<Eigen::MatrixXd> schur_;
};

}  // namespace snapwing::statics
