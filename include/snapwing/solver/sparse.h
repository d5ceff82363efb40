#pragma once
/// Sparse symmetric matrices in compressed columns (lower triangle) and their Cholesky factor (CHOLMOD).

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <algorithm>
#include <memory>
#include <vector>

#include "snapwing/common/loan.h"

namespace snapwing::solver {

/// Coefficients of linear equations, one a row.
using ConstraintRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// Lower triangle, rows ascending in each column, every diagonal entry present.
struct SparsePattern {
  int size = 0;
  std::vector<int> start;  ///< index of each column's first entry, (size + 1)
  std::vector<int> row;    ///< row of each entry
  int entries() const { return static_cast<int>(row.size()); }
  /// Index of an existing entry, row >= column.
  int find(int row_number, int column) const {
    return static_cast<int>(std::lower_bound(row.begin() + start[column], row.begin() + start[column + 1], row_number) -
                            row.begin());
  }
  /// y = A x with A symmetric.
  Eigen::VectorXd multiply(const std::vector<double>& values, const Eigen::VectorXd& x) const;
};

/// Factor of matrices of one pattern, which is analysed once (METIS, or AMD up to 300 unknowns; supernodal). Matrices
/// with small fronts use an own supernodal factor (src/solver/supernodal.h), larger ones CHOLMOD with BLAS. BLAS runs
/// on one thread, so that the bits do not depend on the machine's cores.
class Cholesky : public common::Lender {
 public:
  /// @throws common::Error if the analysis fails
  explicit Cholesky(const SparsePattern& pattern);
  ~Cholesky();
  Cholesky(const Cholesky&) = delete;
  Cholesky& operator=(const Cholesky&) = delete;

  /// Factorises L L^T. @param values  of the matrix in the order of the pattern
  /// @return false if it is not positive definite; there is then no factor
  bool factorize(const std::vector<double>& values);
  /// Factorises L D L^T without pivoting, for an indefinite matrix: slower, and inaccurate near singular minors.
  /// @return number of negative pivots, or -1 if a pivot is zero
  int factorizeIndefinite(const std::vector<double>& values);
  /// Discards the factor, not the analysis.
  void drop();
  /// True if the current factor is L L^T.
  bool definite() const;
  /// Solves with the current factor. @param right  (n x 1), or (n x k) with one right-hand side a column
  /// @throws common::Error without a factor
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const;
  Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;
  /// As solve() to some seven digits, with a symmetric positive definite matrix, for definite() factors: a
  /// preconditioner of conjugate gradients, which costs less where the factor is large.
  Eigen::VectorXd precondition(const Eigen::VectorXd& right) const;
  double factorEntries() const;  ///< nnz(L) of the analysis
  /// Cost of a factorisation in units of one solve, estimated from the analysis, so that it is the same on each
  /// machine.
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
