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
/// @param pattern, values  A, symmetric
/// @param factor           Cholesky factor of a matrix near A
/// @param tolerance        in the unit of b
CgResult conjugateGradients(const SparsePattern& pattern, const std::vector<double>& values, const Cholesky& factor,
                            const Eigen::VectorXd& b, double tolerance, int max_iterations, Eigen::VectorXd& x);

}  // namespace snapwing::solver
