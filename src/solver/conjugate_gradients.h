#pragma once
/// Solves a sparse symmetric system with the factor of a nearby matrix: a few solves in place of a factorization.

#include "snapwing/solver/sparse.h"

namespace snapwing::solver {

struct CgResult {
  bool converged = false;
  bool positive = true;  ///< false: a direction of negative curvature was met; the matrix is not positive definite
  int iterations = 0;    ///< solves with the factor
};

/// Preconditioned conjugate gradients from x = 0: |b - A x| <= tolerance.
/// @param pattern, values  A
/// @param factor           holds the Cholesky factor of a matrix near A
CgResult conjugateGradients(const SparsePattern& pattern, const std::vector<double>& values, const Cholesky& factor,
                            const Eigen::VectorXd& b, double tolerance, int max_iterations, Eigen::VectorXd& x);

}  // namespace snapwing::solver
