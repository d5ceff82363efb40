#pragma once
/// Derivatives of results by the cells' densities, by the adjoint method. With r(z, rho; p) = dPi/dz = 0,
///   dR/drho     = d2Pi/(drho dy) . dy/dp            for the reaction R = dPi/dp, dy/dp the tangent of the path
///   d(a.y)/drho = d2Pi/(drho dy) . (-J H^-1 J^T a)  for a displacement functional
///   dPi/drho    = dPi/drho at fixed y               for the potential at a driven displacement
/// The first is the paper's formula with its sign corrected: J H^-1 enters dy/dp with a minus. What each term has of
/// the densities it says itself (Term::densityDerivative).

#include "snapwing/solver/term_problem.h"

namespace snapwing::solver {

/// Volume of the material that a cell holds at density 1, in the order of cells [m3].
template <int D>
Eigen::VectorXd cellVolumes(const mpm::Discretisation<D>& solid);

/// All at one converged point; `cholesky` must hold the factor of the exact Hessian there. Per cell, in the order of
/// cells.
class Sensitivity {
 public:
  /// @param problem, cholesky  must outlive this
  /// @param at     evaluation of order TANGENT at the equilibrium
  /// @param cells  of the solid
  Sensitivity(const TermProblem& problem, const Cholesky& cholesky, const Evaluation& at, int cells)
      : problem_(problem), cholesky_(cholesky), at_(at), cells_(cells) {}

  Eigen::VectorXd reaction() const;                                       ///< [N]
  Eigen::VectorXd reaction(const Eigen::VectorXd& slope) const;           ///< [N] where slope = dz/dp is known already
  Eigen::VectorXd displacement(const Eigen::VectorXd& functional) const;  ///< of functional . y, (coordinates x 1)
  Eigen::VectorXd energy() const;                                         ///< [J]

 private:
  const TermProblem& problem_;
  const Cholesky& cholesky_;
  const Evaluation& at_;
  int cells_;
};

}  // namespace snapwing::solver
