#pragma once
/// Sparse symmetric matrices in compressed columns (lower triangle) and their Cholesky factor (CHOLMOD).

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <algorithm>
#include <memory>
#include <vector>

#include "snapwing/common/loan.h"

namespace snapwing::solver {

/// Rows of linear equations.
using ConstraintRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// Lower triangle, rows ascending in each column, every diagonal entry present.
struct SparsePattern {
  int size = 0;
  std::vector<int> start;  ///< size + 1
  std::vector<int> row;
  int entries() const { return static_cast<int>(row.size()); }
  /// Place of an entry that exists, row >= column.
  int find(int row_number, int column) const {
    return static_cast<int>(std::lower_bound(row.begin() + start[column], row.begin() + start[column + 1], row_number) -
                            row.begin());
  }
  /// y = A x with A symmetric.
  Eigen::VectorXd multiply(const std::vector<double>& values, const Eigen::VectorXd& x) const;
};

/// Factor with a pattern that is analysed once (METIS, supernodal). BLAS runs on one thread, so that the bits do not
/// depend on the machine's cores.
class Cholesky : public common::Lender {
 public:
  explicit Cholesky(const SparsePattern& pattern);
  ~Cholesky();
  Cholesky(const Cholesky&) = delete;
  Cholesky& operator=(const Cholesky&) = delete;

  /// L L^T of the matrix (values in the order of the pattern). @return false if it is not positive definite; there is
  /// then no factor.
  bool factorize(const std::vector<double>& values);
  /// L D L^T without pivoting, for an indefinite matrix: slower, and only to be trusted away from singular minors.
  /// @return number of negative pivots, or -1 if a pivot vanished
  int factorizeIndefinite(const std::vector<double>& values);
  /// Forgets the factor, not the analysis.
  void drop();
  /// True if the last factorization was L L^T and good.
  bool definite() const;
  /// Solution with the last good factor; right sides (n x 1), or (n x k) one a column.
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const;
  Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;
  double factorEntries() const;  ///< nnz(L) of the analysis
  /// How far a matrix A is from the one that was factorized, F: the largest |eigenvalue| of F^-1 (A - F), by two steps
  /// of the power method from a soft motion without symmetry. Infinite without a Cholesky factor. Well below 1, both
  /// matrices are positive definite.
  double distance(const std::vector<double>& values) const;
  /// What a factorization costs, in solves: estimated from the analysis, so that it is the same on each machine.
  double factorCostInSolves() const;
  int factorizations() const { return factorizations_; }
  double secondsAnalysis() const { return seconds_analysis_; }  ///< [s]
  double secondsFactor() const { return seconds_factor_; }      ///< [s]
  double secondsSolve() const { return seconds_solve_; }        ///< [s]

 private:
  struct Impl;
  Eigen::MatrixXd solvePermuted(const Eigen::MatrixXd& right) const;
  std::unique_ptr<Impl> impl_;
  int factorizations_ = 0;
  double seconds_analysis_ = 0, seconds_factor_ = 0;
  mutable double seconds_solve_ = 0;
};

/// Seconds of a steady clock, for reports.
double secondsNow();

}  // namespace snapwing::solver
