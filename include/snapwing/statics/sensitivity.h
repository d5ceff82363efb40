#pragma once
/// Derivatives of results by the cells' densities, by the adjoint method. With r(z, rho; p) = dPi/dz = 0,
///   dR/drho     = d2E/(drho du) . du/dp            for the reaction R = dPi/dp, du/dp the tangent of the path
///   d(a.u)/drho = d2E/(drho du) . (-T H^-1 T^T a)  for a displacement functional
///   dE/drho     = dE/drho at fixed u               for the energy at a driven displacement, without loads
/// The first is the paper's formula with its sign corrected: T H^-1 enters du/dp with a minus.

#include "snapwing/statics/problem.h"

namespace snapwing::statics {

/// Volume of the material that a cell holds at density 1, in the order of cells [m3].
template <int D>
Eigen::VectorXd cellVolumes(const mpm::Discretisation<D>& solid);

/// All at one converged point; `cholesky` must hold the factor of the exact Hessian there. Per cell, in the order of
/// cells.
template <int D>
class Sensitivity {
 public:
  /// @param problem, cholesky  must outlive this
  /// @param at  evaluation of order TANGENT at the equilibrium
  Sensitivity(const SolidProblem<D>& problem, const Cholesky& cholesky, const Evaluation& at)
      : problem_(problem), cholesky_(cholesky), at_(at) {}

  Eigen::VectorXd reaction() const;                                       ///< [N]
  Eigen::VectorXd reaction(const Eigen::VectorXd& slope) const;           ///< [N] where slope = dz/dp is known already
  Eigen::VectorXd displacement(const Eigen::VectorXd& functional) const;  ///< of functional . u, (dofs x 1)
  Eigen::VectorXd energy() const;                                         ///< [J]
  /// [m3] of sum rho_c m_c
  Eigen::VectorXd volume() const { return cellVolumes(problem_.solid()); }

 private:
  const SolidProblem<D>& problem_;
  const Cholesky& cholesky_;
  const Evaluation& at_;
};

}  // namespace snapwing::statics
