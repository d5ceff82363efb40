#pragma once
/// Conjugate gradients preconditioned with the factor of a nearby matrix: a few solves instead of a factorisation.

#include "snapwing/solver/sparse.h"

namespace snapwing::solver {

struct CgResult {
  bool converged = false;
  bool positive = true;  ///< false: a direction of negative curvature was found; the matrix is not positive definite
  int iterations = 0;    ///< solves with the factor
};

/// Solves A x = b until r = b - A x has |r| <= tolerance (by recurrence).
///
/// What it tells of A: let v be an eigenvector of F^-1 A with an eigenvalue lambda < 0, F the factorised matrix. While
/// no negative curvature is met, the residual's part along v does not shrink: it is the first residual's times prod(1 -
/// lambda / theta_i) >= 1, with the Ritz values theta_i > 0. So if the first residual has a part along every motion and
/// the last one vanishes, A is positive definite.
/// @param pattern, values  A, symmetric
/// @param factor           Cholesky factor of a matrix near A
/// @param tolerance        in the unit of b
/// @param x                in: first guess, zero if its size is not that of b; out: the solution
CgResult conjugateGradients(const SparsePattern& pattern, const std::vector<double>& values, const Cholesky& factor,
                            const Eigen::VectorXd& b, double tolerance, int max_iterations, Eigen::VectorXd& x);

}  // namespace snapwing::solver
