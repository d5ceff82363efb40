#pragma once
/// Singular points of a branch: where a pivot of the Hessian changes its sign between two converged points.
///
/// With phi the mode that loses its stiffness and f = d2Pi/dz dp the load: at a limit point phi . f != 0, the branch
/// runs along phi and the control turns; at a bifurcation phi . f = 0 and another branch leaves along phi.

#include <string>
#include <vector>

#include "snapwing/solver/equilibrium.h"

namespace snapwing::statics {

/// The straight line between two points of a branch; planes across it cut the branch at shares s in [0, 1].
class Chord {
 public:
  Chord(const solver::Equilibrium& a, const solver::Equilibrium& b);
  /// @param s  share of the way from a to b [1]
  solver::BranchPlane plane(double s) const;
  solver::Equilibrium guess(double s) const;
  /// d(control)/ds and d(force)/ds of the branch at a linearised point.
  double controlRate(const solver::Equilibrium& x) const;
  double forceRate(const solver::Equilibrium& x) const;

 private:
  const solver::Equilibrium &a_, &b_;
  Eigen::VectorXd normal_;
};

enum class SingularKind { LIMIT_POINT, BIFURCATION };

struct SingularPoint {
  SingularKind kind = SingularKind::LIMIT_POINT;
  solver::Equilibrium point;  ///< as close as rounding allows
  Eigen::VectorXd mode;       ///< phi, largest entry 1
  double load_share = 0;      ///< |phi . f| / (|phi| |f|)
  double control_rate = 0;    ///< d(control) along the branch, share of that nearby: 0 at a limit point, about 1 else
  double eigenvalue = 0;      ///< what is left of the lowest one [N/m]
  double accuracy = 0;        ///< width of the last bracket in the control
  int before = 0, after = 0;  ///< negative pivots on both sides
  bool followed = false;      ///< the path went on along phi
};

/// @param a, b  linearised points of one branch with different numbers of negative pivots
/// @return false if the corrector lost the branch; `why` then says where
bool locateSingular(solver::EquilibriumSolver& solver, const solver::Equilibrium& a, const solver::Equilibrium& b,
                    SingularPoint& found, std::string& why);

/// A point of the branch that leaves a bifurcation along its mode.
/// @param amount  largest entry of the motion away from the primary branch [m], of either sign
solver::NewtonResult switchBranch(solver::EquilibriumSolver& solver, const SingularPoint& from, double amount,
                                  solver::Equilibrium& found);

}  // namespace snapwing::statics
