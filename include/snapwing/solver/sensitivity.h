#pragma once
/// Derivatives of results by the cells' densities, by the adjoint method. With r(z, rho; p) = dPi/dz = 0,
///   dR/drho     = d2E/(drho du) . du/dp            for the reaction R = dPi/dp, du/dp the tangent of the path
///   d(a.u)/drho = d2E/(drho du) . (-T H^-1 T^T a)  for a displacement functional
///   dPi/drho    = dPi/drho at fixed u              for the potential at a driven displacement
/// where loads l(rho) that follow the densities, as weight does, add -d(l.u)/drho to the energy's derivatives. The
/// first is the paper's formula with its sign corrected: T H^-1 enters du/dp with a minus.

#include <functional>
#include <utility>

#include "snapwing/solver/problem.h"

namespace snapwing::solver {

/// Volume of the material that a cell holds at density 1, in the order of cells [m3].
template <int D>
Eigen::VectorXd cellVolumes(const mpm::Discretisation<D>& solid);

using LoadSlope = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;

/// All at one converged point; `cholesky` must hold the factor of the exact Hessian there. Per cell, in the order of
/// cells.
template <int D>
class Sensitivity {
 public:
  /// @param problem, cholesky  must outlive this
  /// @param at  evaluation of order TANGENT at the equilibrium
  /// @param load_slope  v -> d(l . v)/drho_c (cells x 1) of loads that follow the densities; empty: there are none
  Sensitivity(const SolidProblem<D>& problem, const Cholesky& cholesky, const Evaluation& at, LoadSlope load_slope = {})
      : problem_(problem), cholesky_(cholesky), at_(at), load_slope_(std::move(load_slope)) {}

  Eigen::VectorXd reaction() const;                                       ///< [N]
  Eigen::VectorXd reaction(const Eigen::VectorXd& slope) const;           ///< [N] where slope = dz/dp is known already
  Eigen::VectorXd displacement(const Eigen::VectorXd& functional) const;  ///< of functional . u, (dofs x 1)
  Eigen::VectorXd energy() const;                                         ///< of the potential [J]
  /// [m3] of sum rho_c m_c
  Eigen::VectorXd volume() const { return cellVolumes(problem_.solid()); }

 private:
  /// d(r . v)/drho_c of the nodal residual r; without v the potential's own.
  Eigen::VectorXd residualSlope(const Eigen::VectorXd& v) const;

  const SolidProblem<D>& problem_;
  const Cholesky& cholesky_;
  const Evaluation& at_;
  LoadSlope load_slope_;
};

}  // namespace snapwing::solver
