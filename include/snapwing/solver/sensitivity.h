#pragma once
/// Derivatives of results with respect to the cells' densities rho, by the adjoint method. With the potential
/// Pi(y(z, p), rho) and kept constraints C z - D p - e = 0 of multipliers lambda,
///   dR/drho     = d2Pi/(drho dy) . dy/dp  for the reaction R = dPi/dp, dy/dp the tangent of the path
///   d(a.y)/drho = d2Pi/(drho dy) . J w    for a displacement functional, [w, nu] = -[H C^T; C 0]^-1 [J^T a; 0]
///   dPi/drho    = dPi/drho at fixed y     for the potential at a driven displacement
/// The first is the paper's formula with its sign corrected: J H^-1 enters dy/dp with a minus. Each term supplies its
/// part by Term::densityDerivative.

#include <utility>

#include "snapwing/common/loan.h"
#include "snapwing/solver/tangent_system.h"
#include "snapwing/solver/term_problem.h"

namespace snapwing::solver {

/// A direction in the space of all unknowns.
struct Variation {
  Eigen::VectorXd z, multipliers;  ///< (free x 1); (kept constraints x 1), empty without
  Eigen::VectorXd y;               ///< full coordinates, (full x 1)
};

/// Derivatives at one converged point with one control. Results are per cell, (cells x 1).
class Sensitivity {
 public:
  /// @param system  factorised at the point; lent, as `problem`
  /// @param at     evaluation of order TANGENT at the equilibrium
  /// @param cells  number of cells of the solid
  Sensitivity(const TermProblem& problem, const TangentSystem& system, Evaluation at, int cells)
      : problem_(problem), system_(system), at_(std::move(at)), cells_(cells) {}

  /// d(z, lambda, y)/dp along the branch: one solve.
  Variation tangent() const;
  /// Likewise from a known slope = dz/dp, without multipliers and without a solve.
  Variation tangent(const Eigen::VectorXd& slope) const;
  /// [w, nu] of a displacement functional: one solve. @param functional  a = d(result)/dy, (at most full x 1)
  Variation adjoint(const Eigen::VectorXd& functional) const;

  Eigen::VectorXd reaction(const Variation& tangent) const { return along(tangent); }      ///< dR/drho [N]
  Eigen::VectorXd displacement(const Variation& adjoint) const { return along(adjoint); }  ///< d(a.y)/drho
  Eigen::VectorXd potential() const;                                                       ///< dPi/drho [J]

 private:
  Eigen::VectorXd along(const Variation& direction) const;

  common::Loan<const TermProblem> problem_;
  common::Loan<const TangentSystem> system_;
  Evaluation at_;
  int cells_;
};

}  // namespace snapwing::solver
