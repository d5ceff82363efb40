#pragma once
/// Conjugate gradients preconditioned with the factor of a nearby matrix: a few solves instead of a factorisation.

#include "snapwing/solver/sparse.h"

namespace snapwing::solver {

struct CgResult {
  bool converged = false;
  bool positive = true;  ///< false: a direction of negative curvature was found; the matrix is not positive definite
  int iterations = 0;    ///< solves with the factor
};

/// Solves A x = b from x = 0 until |b - A x| <= tolerance (residual by recurrence).
///
/// What it tells of A: let v be an eigenvector of F^-1 A with an eigenvalue lambda < 0, F the factorised matrix. While
/// no negative curvature is met, the residual's part along v does not shrink: it is that of b times prod(1 - lambda /
/// theta_i) >= 1, with the Ritz values theta_i > 0. So if b has a part along every motion and the residual vanishes, A
/// is positive definite.
/// @param pattern, values  A, symmetric
/// @param factor           Cholesky factor of a matrix near A
/// @param tolerance        in the unit of b
CgResult conjugateGradients(const SparsePattern& pattern, const std::vector<double>& values, const Cholesky& factor,
                            const Eigen::VectorXd& b, double tolerance, int max_iterations, Eigen::VectorXd& x);

}  // namespace snapwing::solver
