#pragma once
/// What the elastic rungs of the wing's linkage have in common: beams (linkage_elastic.h) and solids on the mpm layer
/// (linkage_solid.h). Displacements live on the common rest plane, joints are linear equalities between interpolated
/// displacements, the arm's rotation drives:
///     min_q E(q; X) - f.q   s.t.   H q = h(theta)
///     saddle point  [K H^T; H 0] [dq; dlambda] = -[grad E - f + H^T lambda; H q - h]
///     dL/dX = L_X - y^T d(grad E - f + H^T lambda)/dX - z^T d(H q - h)/dX,   [K H^T; H 0] [y; z] = [L_q; 0]
/// f: friction moments of the pins, against the motion that the rigid rung predicts.

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "snapwing/design/wing/linkage_four_bar.h"
#include "snapwing/design/wing/wing_settings.h"
#include "snapwing/solver/joint_equilibrium.h"

namespace snapwing::design {

using JointSolver = solver::Enforcement;

/// A further point held to ground; body 0 arm, 1 wing, 2 rocker; bar in the rung's order; fraction 0..1 along it.
struct GroundPin {
  int body = 0, bar = 0;
  double fraction = 0;
};

enum class ElasticStatus { NOT_SOLVED, CONVERGED, NOT_CONVERGED, RANK_DEFICIENT };

struct ElasticState {
  ElasticStatus status = ElasticStatus::NOT_SOLVED;
  std::string message;
  double theta = 0;                     ///< [rad]
  Eigen::VectorXd q;                    ///< the rung's unknowns: displacements [m], rotations of beams [rad]
  Eigen::VectorXd forces;               ///< Lagrange multipliers of the rows of H [N]
  double energy = 0;                    ///< stored in the bars [J]
  double largest_stress = 0;            ///< beams: |axial| + |bending| at the edge; solids: von Mises in cells [Pa]
  Eigen::Vector2d joint1, joint2, tip;  ///< [m]
  double wing_rotation = 0;             ///< of the wing at joint 2 [rad]
  double constraint_residual = 0;       ///< largest violation of H q = h [m]
  bool stable = false;                  ///< a minimum among all q with H q = h
  int iterations = 0;
};

/// First derivatives of a state with respect to X, by four solves with the saddle-point matrix.
struct ElasticSensitivity {
  Eigen::Matrix<double, 2, 4> joint1, joint2, tip;  ///< [1]
  Eigen::RowVector4d wing_rotation;                 ///< [1/m]
  Eigen::RowVector4d energy;                        ///< [J/m]
};

/// dL by the quantities of a state, for one adjoint solve.
struct StateSlopes {
  Eigen::Vector2d joint1 = Eigen::Vector2d::Zero(), joint2 = Eigen::Vector2d::Zero(), tip = Eigen::Vector2d::Zero();
  double wing_rotation = 0, energy = 0;
};

/// One layout on one elastic rung. Holds its factors: one thread at a time.
class LinkageModel {
 public:
  virtual ~LinkageModel() = default;
  /// Equilibrium at theta [rad]. @param guess  state to start from; null: the rigid position where it exists
  virtual ElasticState solve(double theta, const ElasticState* guess = nullptr) const = 0;
  /// @throws common::Error where the state is no equilibrium; so does gradient()
  virtual ElasticSensitivity sensitivity(const ElasticState& state) const = 0;
  /// dL/dX of an L that depends on X only through the state, by one adjoint solve.
  virtual Eigen::Vector4d gradient(const ElasticState& state, const StateSlopes& L) const = 0;
  virtual const FourBar& layout() const = 0;
  virtual int unknowns() const = 0;  ///< coordinates and multipliers of one equilibrium

  /// Equilibria at increasing theta, each from the rigid position, or from the one before where bars do not reach.
  std::vector<ElasticState> trace(const std::vector<double>& thetas) const;
  /// At theta from the rigid position, or followed from rest where rigid bars would not reach.
  ElasticState reach(double theta) const;
};

using LinkageFactory = std::function<std::unique_ptr<LinkageModel>(const FourBar& layout)>;

/// Moments of dry friction against the motion that the rigid rung has at theta, in the sense of growing theta.
struct PinMoments {
  double axle = 0;       ///< on the arm, from ground [N m]
  double joint1 = 0;     ///< on the wing; the arm gets the opposite
  double joint2 = 0;     ///< on the wing; the rocker gets the opposite
  double auxiliary = 0;  ///< on the rocker, from ground
};
/// Zero where the rigid loop does not close.
PinMoments frictionAt(const FourBar& layout, const WingBars& bars, double theta);

}  // namespace snapwing::design
