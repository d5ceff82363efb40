#pragma once
/// Finds and describes single equilibria of a problem with one control, whatever way its ports and joints are imposed.
/// Paths, arcs, singular points and exact features are built from these moves.

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <memory>

#include "snapwing/solver/newton.h"
#include "snapwing/solver/tied_problem.h"

namespace snapwing::solver {

/// A point with its derivatives along the branch, as far as settle() filled them in.
struct Equilibrium {
  Eigen::VectorXd p = Eigen::VectorXd::Zero(1);  ///< the control
  Eigen::VectorXd z;                             ///< free coordinates
  Eigen::VectorXd multipliers;                   ///< of ties; empty without
  Evaluation at;                                 ///< of order TANGENT at (z, p)
  Eigen::VectorXd slope, multiplier_slope;       ///< dz/dp, dlambda/dp; zero where they do not exist
  Eigen::VectorXd load;                          ///< d2L/dz dp
  double control_curvature = 0;                  ///< d2L/dp2 at fixed z and multipliers
  double stiffness = 0;                          ///< d(force)/dp along the branch
  int negative_pivots = -1;                      ///< of the Hessian on admissible motions; -1 unknown
  double force() const { return at.control_force(0); }
};

/// Plane normal.(z - origin) + control_normal (p - control) = distance in the space of branches.
struct BranchPlane {
  Eigen::VectorXd origin, normal;
  double control = 0, control_normal = 0, distance = 0;
};

/// Linear systems [H C^T; C 0] (H without ties) at one point. The Hessian of a tied problem contains rho C^T C, which
/// changes nothing where C z = 0; its negative pivots on admissible motions are those of H less those of the Schur
/// complement S = C H^-1 C^T.
class TangentSystem {
 public:
  TangentSystem(const Problem& problem, Cholesky& cholesky) : problem_(problem), cholesky_(cholesky) {}
  /// @return true if positive definite on admissible motions
  bool factorizeDefinite(const std::vector<double>& hessian);
  /// Of any inertia. @return negative pivots, -1 if singular
  int factorize(const std::vector<double>& hessian);
  /// Solves H z + C^T lambda = f, C z = g; `lambda` is empty without ties.
  void solve(const Eigen::VectorXd& f, const Eigen::VectorXd& g, Eigen::VectorXd& z, Eigen::VectorXd& lambda) const;
  /// The same for several right-hand sides, one a column.
  void solve(const Eigen::MatrixXd& f, const Eigen::MatrixXd& g, Eigen::MatrixXd& z, Eigen::MatrixXd& lambda) const;

 private:
  int formSchur();
  template <class Dense>
  void solveAny(const Dense& f, const Dense& g, Dense& z, Dense& lambda) const;

  const Problem& problem_;
  Cholesky& cholesky_;
  Eigen::MatrixXd spread_;  ///< H^-1 C^T
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> schur_;
};

class EquilibriumSolver {
 public:
  /// @param problem  with exactly one control; must outlive this
  EquilibriumSolver(const Problem& problem, const NewtonSettings& settings);

  /// The problem that is solved: differs from the given one in its multipliers only.
  const Problem& problem() const { return tied_ ? *tied_ : problem_; }
  int tieCount() const { return tied_ ? tied_->ties().count() : 0; }
  /// Moves the places at which ties are held: e of TiedProblem [m]. Only with ties.
  void setTieConstant(const Eigen::VectorXd& constant) { tied_->setConstant(constant); }
  /// Tangent of an evaluation; holds the factor of the last one asked for, until the next equilibrium.
  TangentSystem& system() { return system_; }
  /// The undeformed start at a control.
  Equilibrium start(const Eigen::VectorXd& z, double p) const;
  /// Minimises: ends at stable equilibria, however far, unless symmetry keeps it from it. `x` holds the first guess,
  /// and where it stopped on failure.
  NewtonResult minimise(Equilibrium& x);
  /// Newton without line search at fixed control: the equilibrium nearby, stable or not.
  NewtonResult correct(Equilibrium& x);
  /// The same with the control free, on a plane.
  NewtonResult correctOn(const BranchPlane& plane, Equilibrium& x);
  /// Inertia and derivatives at a converged point. @return factorizations spent
  int settle(Equilibrium& x);
  /// Settles anew and forgets everything before: a run that starts here gives the same bits.
  int anchor(Equilibrium& x) {
    newton_.forget();
    return settle(x);
  }
  /// The same for a point close to where the last factor belongs to: without a new factor if the Hessian has changed by
  /// less than a hundredth (Cholesky::distance), which leaves the inertia what it was.
  int settleNear(Equilibrium& x);
  /// First guess at another control, from a settled point.
  Equilibrium predict(const Equilibrium& from, double p) const;
  /// Motion of the smallest Hessian's eigenvalue by magnitude (unit length), at a settled point, and that value [N/m].
  /// @param iterations  of the inverse iteration, at most
  double softestMode(const Equilibrium& x, Eigen::VectorXd& mode, int iterations = 50) const;
  /// False if some motion costs nothing but rounding, at a settled point.
  bool supported(const Equilibrium& x) const;

  double secondsAssembly() const { return seconds_assembly_ + newton_.secondsAssembly(); }
  const Cholesky& cholesky() const { return newton_.cholesky(); }

 private:
  void evaluate(const Equilibrium& x, Order order, Evaluation& at);
  Eigen::VectorXd gap(const Equilibrium& x) const;
  bool balanced(const Equilibrium& x) const;
  NewtonResult augment(Equilibrium& x);
  NewtonResult saddle(Equilibrium& x);
  bool saddleDirection(const Equilibrium& x, NewtonResult& result, Eigen::VectorXd& dz, Eigen::VectorXd& dl);
  bool saddleStep(const Eigen::VectorXd& dz, const Eigen::VectorXd& dl, Equilibrium& x);

  const Problem& problem_;
  NewtonSettings settings_;
  std::unique_ptr<TiedProblem> tied_;  ///< own copy, with the current multipliers
  mutable Newton newton_;
  TangentSystem system_;
  Evaluation trial_;
  double seconds_assembly_ = 0;
};

}  // namespace snapwing::solver
