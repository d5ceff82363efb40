#pragma once
/// Singular points of a branch: a pivot of the Hessian changes its sign between two converged points.
///
/// phi: the mode whose eigenvalue becomes zero; f = d2Pi/dz dp: the load. At a limit point phi . f != 0, the branch is
/// tangent to phi and the control reverses. At a bifurcation phi . f = 0, and another branch leaves along phi.

#include <string>
#include <vector>

#include "snapwing/solver/equilibrium.h"

namespace snapwing::statics {

/// The straight line between two points of a branch. Planes normal to it intersect the branch at shares s in [0, 1].
class Chord {
 public:
  /// Keeps references to both points.
  Chord(const solver::Equilibrium& a, const solver::Equilibrium& b);
  /// @param s  share of the distance from a to b [1]
  solver::BranchPlane plane(double s) const;
  /// Linear interpolation between the points.
  solver::Equilibrium guess(double s) const;
  /// d(control)/ds, and d(force)/ds [N], of the branch at a linearised point.
  double controlRate(const solver::Equilibrium& x) const;
  double forceRate(const solver::Equilibrium& x) const;

 private:
  const solver::Equilibrium &a_, &b_;
  Eigen::VectorXd normal_;
};

enum class SingularKind { LIMIT_POINT, BIFURCATION };

struct SingularPoint {
  SingularKind kind = SingularKind::LIMIT_POINT;
  solver::Equilibrium point;  ///< end of the last bracket with the smaller |eigenvalue|; its Hessian is discarded
  Eigen::VectorXd mode;       ///< phi, largest entry 1, (free x 1)
  double load_share = 0;      ///< |phi . f| / (|phi| |f|) [1]
  double control_rate = 0;    ///< d(control)/ds over that at the ends [1]: 0 at a limit point, else about 1
  double eigenvalue = 0;      ///< lowest one at the point [N/m]
  double accuracy = 0;        ///< width of the last bracket [unit of the control]
  int before = 0, after = 0;  ///< negative pivots on both sides
  bool followed = false;      ///< the path continued along phi
};

/// Locates the singular point between two points; it is a limit point if control_rate < 0.02.
/// @param a, b  linearised points of one branch with different numbers of negative pivots
/// @return false if the corrector lost the branch; `why` is then the reason
bool locateSingular(solver::EquilibriumSolver& solver, const solver::Equilibrium& a, const solver::Equilibrium& b,
                    SingularPoint& found, std::string& why);

/// Solves for a point of the branch that leaves a bifurcation along its mode.
/// @param amount  [m] largest entry of the motion's part along the mode, either sign
solver::NewtonResult switchBranch(solver::EquilibriumSolver& solver, const SingularPoint& from, double amount,
                                  solver::Equilibrium& found);

}  // namespace snapwing::statics
