#pragma once
/// The convex, separable subproblem of MMA [Svanberg 1987; 2002]:
///   min  f0(x) + sum_i (c y_i + y_i^2 / 2)   s.t.  f_i(x) - y_i <= 0,  alpha <= x <= beta,  y >= 0
///   f_i(x) = r_i + sum_j p_ij / (U_j - x_j) + q_ij / (x_j - L_j)
/// Its dual in lambda >= 0 is concave and has few unknowns: Newton on the dual with a logarithmic barrier.

#include <Eigen/Core>

namespace snapwing::design {

struct MmaSubproblem {
  Eigen::VectorXd low, high;    ///< asymptotes L, U
  Eigen::VectorXd alpha, beta;  ///< L < alpha <= beta < U
  Eigen::MatrixXd p, q;         ///< (n x (m + 1)), >= 0; column 0 is the objective
  Eigen::VectorXd r;            ///< ((m + 1) x 1)
  double penalty = 1000;        ///< c

  /// Values of objective and constraints of the approximation.
  Eigen::VectorXd values(const Eigen::VectorXd& x) const;
  /// @param lambda  out: multipliers of the constraints
  Eigen::VectorXd solve(Eigen::VectorXd* lambda = nullptr) const;

 private:
  struct Dual;
  Eigen::VectorXd primal(const Eigen::VectorXd& lambda) const;
  Eigen::MatrixXd curvatureAt(const Eigen::VectorXd& weight, const Eigen::VectorXd& x) const;
  Dual dual(const Eigen::VectorXd& lambda, double barrier, bool curvature) const;
};

}  // namespace snapwing::design
