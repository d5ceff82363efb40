#pragma once
/// Solves for single equilibria of a problem and linearises there, with any enforcement of its constraints. Paths,
/// arcs, singular points and features (statics/) are built from these operations.

#include <Eigen/Core>

#include "snapwing/common/loan.h"
#include "snapwing/solver/newton.h"
#include "snapwing/solver/tangent_system.h"

namespace snapwing::solver {

/// An equilibrium; linearise() fills in the derivatives along the branch. L: Lagrangian, or Pi without constraints.
struct Equilibrium {
  Eigen::VectorXd p = Eigen::VectorXd::Zero(1);         ///< the control, or t of a ControlLine, (1 x 1)
  Eigen::VectorXd z;                                    ///< free coordinates, (free x 1) [m]
  Eigen::VectorXd multipliers;                          ///< of constraints [N]; empty without
  Evaluation at;                                        ///< of order TANGENT at (z, p)
  Eigen::VectorXd slope, multiplier_slope;              ///< dz/dp, dlambda/dp; zero where they do not exist
  Eigen::VectorXd load;                                 ///< d2L/dz dp, (free x 1)
  double control_curvature = 0;                         ///< d2L/dp2 at fixed z and multipliers
  double stiffness = 0;                                 ///< d(force)/dp along the branch
  int negative_pivots = -1;                             ///< of the Hessian on admissible motions; -1 unknown
  double force() const { return at.control_force(0); }  ///< dPi/dp; [N] for a travel in m
};

/// Plane normal.(z - origin) + control_normal (p - control) = distance in the space of (z, p).
struct BranchPlane {
  Eigen::VectorXd origin, normal;
  double control = 0, control_normal = 0, distance = 0;
};

/// A line of controls, p = start + t direction: t is the one control of a path if the problem has several or none.
struct ControlLine {
  Eigen::VectorXd start, direction;  ///< (controls x 1), each in its own unit
};

class EquilibriumSolver {
 public:
  /// @param problem  lent; @param line  of the controls; may be left out if there is exactly one
  /// @throws common::Error if the sizes of the line are not the problem's number of controls
  EquilibriumSolver(const Problem& problem, const NewtonSettings& settings, ControlLine line = {});

  EquilibriumSolver(const EquilibriumSolver&) = delete;  // its tangent system has the factor lent
  EquilibriumSolver& operator=(const EquilibriumSolver&) = delete;

  const Problem& problem() const { return *problem_; }
  int constraintCount() const { return constraints_ ? constraints_->count() : 0; }
  /// Sets the line for later solves. @throws common::Error as the constructor
  void setLine(ControlLine line);
  /// The problem's controls at the control t of an equilibrium, (controls x 1).
  Eigen::VectorXd controls(double t) const;
  /// Tangent system with the last factor; the next solve or linearise() overwrites it.
  TangentSystem& system() { return system_; }
  /// A point with free coordinates z, control p and zero multipliers; not evaluated.
  Equilibrium start(const Eigen::VectorXd& z, double p) const;
  /// Newton with line search at fixed control: minimises the potential, so that it converges to stable equilibria, also
  /// far ones, unless a symmetry of the guess prevents it.
  /// @param x  in: first guess; out: solution, or the last iterate on failure
  NewtonResult minimise(Equilibrium& x);
  /// Newton without line search at fixed control: converges to a nearby equilibrium, stable or not.
  NewtonResult correct(Equilibrium& x);
  /// As correct(), with the control free, on a plane.
  NewtonResult correctOn(const BranchPlane& plane, Equilibrium& x);
  /// Evaluates `x.at` at the point as it is.
  void evaluate(Equilibrium& x, Order order = Order::TANGENT) { evaluate(x, order, x.at); }
  /// Factorises the tangent at a converged point: inertia of the pivots and derivatives along the branch.
  /// @return number of factorisations
  int linearise(Equilibrium& x);
  /// Factorises the tangent of an evaluated point for the inertia of its pivots alone; -1: singular to rounding.
  int inertia(const Equilibrium& x) { return system_.factorize(x.at); }
  /// Linearises and discards the history: a run resumed here has the same bits (restart point).
  int restart(Equilibrium& x);
  /// Discards the factor as well: the next solve is that of a new object.
  void restart();
  /// As linearise(), without a new factorisation if conjugate gradients with the factor at hand find the slope in fewer
  /// solves than one costs, and meet no negative curvature: a probe in their right side shows that the Hessian is
  /// positive definite (src/solver/conjugate_gradients.h). @return number of factorisations, 0 or 1
  /// @param guess  of dz/dp, or empty
  int lineariseNear(Equilibrium& x, const Eigen::VectorXd& guess = Eigen::VectorXd());
  /// Evaluates a point that was linearised before and fills in its derivatives from the stored slope, without a factor.
  /// @return false if it is no equilibrium to the tolerance, or if there are constraints
  bool recall(const Eigen::VectorXd& slope, int negative_pivots, Equilibrium& x);
  /// As recall(), at a point between two stable ones on one series: the stiffness is exact to the square of the slope's
  /// error.
  bool settle(const Eigen::VectorXd& slope, Equilibrium& x);
  /// Residual over its tolerance at an evaluated point; infinite where an element is inverted.
  double imbalance(const Equilibrium& x) const;
  /// First guess at the control p by the tangent of a linearised point.
  Equilibrium predict(const Equilibrium& from, double p) const;
  /// Eigenvalue of the Hessian that is smallest by magnitude [N/m], on admissible motions, at a linearised point.
  /// @param mode  its eigenvector, unit length; @param iterations  of the inverse iteration, at most
  double softestMode(const Equilibrium& x, Eigen::VectorXd& mode, int iterations = 50) const;
  /// False if the energy of some motion is zero to rounding, at a linearised point.
  bool supported(const Equilibrium& x) const;

  double secondsAssembly() const { return seconds_assembly_ + newton_.secondsAssembly(); }  ///< wall time so far [s]
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
  void findProbe(const Equilibrium& x, Eigen::VectorXd& load);

  common::Loan<const Problem> problem_;
  NewtonSettings settings_;
  const Constraints* constraints_;  ///< the problem's; null without
  ControlLine line_;
  bool one_control_ = true;  ///< and no line
  mutable Newton newton_;
  TangentSystem system_;
  Evaluation trial_;
  Eigen::VectorXd probe_;  ///< of lineariseNear() since the last restart; empty before the first
  double probe_push_ = 0;  ///< norm of the load that it was found by
  double seconds_assembly_ = 0;
};

}  // namespace snapwing::solver
