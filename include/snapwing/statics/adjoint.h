#pragma once
/// Derivatives by the cells' densities at an equilibrium, by the adjoint method: one factorization for all of them.
///
/// With Pi(z; p, rho) stationary in z, H = d2Pi/dz2:
///   reaction    R = dPi/dp:  dR/drho = d2Pi/drho dp - (d2Pi/drho dz) H^-1 (d2Pi/dz dp)      (mind the minus)
///               = d2E/drho du . w,   w = du/dp along the path: the tangent of the path is the adjoint state
///   functional  g(u):        dg/drho = -(d2E/drho du) . T H^-1 T^T dg/du
///   energy      E(u(rho), rho) at held controls: dE/drho, explicit part only
/// All hold at unstable equilibria too, as long as H is regular.

#include <Eigen/Core>

#include "snapwing/statics/problem.h"

namespace snapwing::statics {

/// One converged point; problem, evaluation and factor must outlive this and stay unchanged.
template <int D>
class Adjoint {
 public:
  /// @param problem   without dead loads that depend on the density
  /// @param at        evaluation of order TANGENT at the equilibrium
  /// @param cholesky  of the problem's pattern; is given the factor of at.hessian here
  Adjoint(const SolidProblem<D>& problem, const Evaluation& at, Cholesky& cholesky);

  /// False if H is singular to rounding: nothing below may then be asked for.
  bool regular() const { return negative_pivots_ >= 0; }
  /// Negative eigenvalues of H; 0 at a stable equilibrium.
  int negativePivots() const { return negative_pivots_; }

  /// dR_k/drho, (cellCount x 1) [N].
  Eigen::VectorXd reaction(int control) const;
  /// dR_k/dp_k along the path [N/m].
  double stiffness(int control) const;
  /// dg/drho for each column dg/du (dofCount x count); (cellCount x count).
  Eigen::MatrixXd functionals(const Eigen::MatrixXd& by_displacement) const;
  /// dE/drho, (cellCount x 1) [J].
  Eigen::VectorXd energy() const;

 private:
  Eigen::VectorXd pathTangent(int control, double& stiffness) const;

  const SolidProblem<D>& problem_;
  const Evaluation& at_;
  const Cholesky& cholesky_;
  int negative_pivots_ = -1;
};

}  // namespace snapwing::statics
