#pragma once
/// Finds and describes single equilibria of a problem, whatever way its constraints are enforced. Paths, arcs, singular
/// points and exact features are built from these moves.

#include <Eigen/Core>

#include "snapwing/common/loan.h"
#include "snapwing/solver/newton.h"
#include "snapwing/solver/tangent_system.h"

namespace snapwing::solver {

/// A point with its derivatives along the branch, as far as linearise() filled them in.
struct Equilibrium {
  Eigen::VectorXd p = Eigen::VectorXd::Zero(1);         ///< the control, or t on a line of controls
  Eigen::VectorXd z;                                    ///< free coordinates
  Eigen::VectorXd multipliers;                          ///< of constraints; empty without
  Evaluation at;                                        ///< of order TANGENT at (z, p)
  Eigen::VectorXd slope, multiplier_slope;              ///< dz/dp, dlambda/dp; zero where they do not exist
  Eigen::VectorXd load;                                 ///< d2L/dz dp
  double control_curvature = 0;                         ///< d2L/dp2 at fixed z and multipliers
  double stiffness = 0;                                 ///< d(force)/dp along the branch
  int negative_pivots = -1;                             ///< of the Hessian on admissible motions; -1 unknown
  double force() const { return at.control_force(0); }  ///< dPi/dp; [N] for a travel in m
};

/// Plane normal.(z - origin) + control_normal (p - control) = distance in the space of branches.
struct BranchPlane {
  Eigen::VectorXd origin, normal;
  double control = 0, control_normal = 0, distance = 0;
};

/// The controls on a line, p = start + t direction: the one control of a path where a problem has several or none.
struct ControlLine {
  Eigen::VectorXd start, direction;  ///< (controls x 1), each in its own unit
};

class EquilibriumSolver {
 public:
  /// @param line     of the controls; may be left out if there is exactly one
  /// @throws common::Error if the line has other controls than the problem
  EquilibriumSolver(const Problem& problem, const NewtonSettings& settings, ControlLine line = {});

  EquilibriumSolver(const EquilibriumSolver&) = delete;  // its tangent system has the factor lent
  EquilibriumSolver& operator=(const EquilibriumSolver&) = delete;

  const Problem& problem() const { return *problem_; }
  int constraintCount() const { return constraints_ ? constraints_->count() : 0; }
  /// Another line, for solves to come. @throws common::Error as the constructor
  void setLine(ControlLine line);
  /// The problem's controls at the control t of an equilibrium.
  Eigen::VectorXd controls(double t) const;
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
  /// Fills in `at` at the point as it is.
  void evaluate(Equilibrium& x) { evaluate(x, Order::TANGENT, x.at); }
  /// Inertia and derivatives at a converged point. @return factorizations spent
  int linearise(Equilibrium& x);
  /// Linearises anew and forgets everything before: a run that starts here gives the same bits.
  int restart(Equilibrium& x) {
    newton_.forget();
    return linearise(x);
  }
  /// Forgets the factor as well: what follows is what a new object would do.
  void restart() { newton_.restart(); }
  /// The same for a point close to where the last factor belongs to: without a new factor if the Hessian has changed by
  /// less than a hundredth (Cholesky::distance), which leaves the inertia what it was.
  int lineariseNear(Equilibrium& x);
  /// Evaluates a point that was linearised before: with its slope and inertia of then the rest needs no factor.
  /// @return false if it is no equilibrium to the tolerance, or if there are constraints
  bool recall(const Eigen::VectorXd& slope, int negative_pivots, Equilibrium& x);
  /// First guess at another control, from a linearised point.
  Equilibrium predict(const Equilibrium& from, double p) const;
  /// Motion of the smallest Hessian's eigenvalue by magnitude (unit length), at a linearised point, and that value
  /// [N/m].
  /// @param iterations  of the inverse iteration, at most
  double softestMode(const Equilibrium& x, Eigen::VectorXd& mode, int iterations = 50) const;
  /// False if some motion costs nothing but rounding, at a linearised point.
  bool supported(const Equilibrium& x) const;

  double secondsAssembly() const { return seconds_assembly_ + newton_.secondsAssembly(); }
  const Cholesky& cholesky() const { return newton_.cholesky(); }

 private:
  void evaluate(const Equilibrium& x, Order order, Evaluation& at);
  void alongLine(Evaluation& at) const;
  Eigen::VectorXd driven() const;
  bool closed(const Equilibrium& x) const;
  bool balanced(const Equilibrium& x) const;
  void estimateMultipliers(Equilibrium& x);
  NewtonResult augment(Equilibrium& x);
  NewtonResult saddle(Equilibrium& x);
  bool saddleDirection(const Equilibrium& x, NewtonResult& result, Eigen::VectorXd& dz, Eigen::VectorXd& dl);
  bool saddleStep(const Eigen::VectorXd& dz, const Eigen::VectorXd& dl, Equilibrium& x);
  bool curvedStep(const Eigen::VectorXd& dz, const Eigen::VectorXd& dl, Equilibrium& x);

  common::Loan<const Problem> problem_;
  NewtonSettings settings_;
  const Constraints* constraints_;  ///< the problem's; null without
  ControlLine line_;
  bool one_control_ = true;  ///< and no line
  mutable Newton newton_;
  TangentSystem system_;
  Evaluation trial_;
  double seconds_assembly_ = 0;
};

}  // namespace snapwing::solver
