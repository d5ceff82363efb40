#pragma once
/// The wing's linkage with elastic bars: the check of the rigid rung, and its stress and stored energy.
///
/// Three bodies of straight bars between joints - arm (port P, axle A, X1), wing (X1, X2, tip) and rocker (auxiliary B,
/// X2) - as geometrically exact planar beams (Simo 1985: linear elements, one point of integration, so no locking).
/// Displacements u live on the common rest plane; joints are linear equalities between interpolated displacements, as
/// in Li et al., "joint_equilibrium":
///     min_q E(q; X) - f.q   s.t.   H q = h(theta)
/// with rows u_arm(A) = 0, u_arm(P) = (R(theta) - 1) P, u_arm(X1) = u_wing(X1), u_wing(X2) = u_rocker(X2),
/// u_rocker(B) = 0. The bars' material follows X; H does not depend on X, because joints keep their place within
/// their elements. f: friction moments of the pins, against the motion that the rigid rung predicts.
///     saddle point  [K H^T; H 0] [dq; dlambda] = -[grad E - f + H^T lambda; H q - h]
///     dL/dX = L_X - y^T d2E/dq dX,   [K H^T; H 0] [y; z] = [L_q; 0]
/// These are beams, not the solid of the mpm floor: docs/decisions.md says why.

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "snapwing/design/linkage_four_bar.h"
#include "snapwing/design/wing_settings.h"

namespace snapwing::design {

enum class JointSolver { LAGRANGE, AUGMENTED_LAGRANGIAN };

/// A further point held to ground; body 0 arm, 1 wing, 2 rocker; bar in the order above; fraction 0..1 along it.
struct GroundPin {
  int body = 0, bar = 0;
  double fraction = 0;
};

struct ElasticSettings {
  int elements_per_bar = 6;      ///< 1 .. 200
  double overhang = 0.08;        ///< bars reach beyond a free joint by this share of their length; 0: joint on a node
  double driver_length = 0.060;  ///< [m] P lies this far inward of the axle; the arm as a straight bar
  JointSolver solver = JointSolver::LAGRANGE;
  int max_iterations = 60;
  std::vector<GroundPin> ground_pins;
  void validate() const;
};

enum class ElasticStatus { NOT_SOLVED, CONVERGED, NOT_CONVERGED, RANK_DEFICIENT };

struct ElasticState {
  ElasticStatus status = ElasticStatus::NOT_SOLVED;
  std::string message;
  double theta = 0;                     ///< [rad]
  Eigen::VectorXd q;                    ///< per node u_x, u_y [m], rotation [rad]
  Eigen::VectorXd forces;               ///< Lagrange multipliers of the rows of H [N]
  double energy = 0;                    ///< stored in the bars [J]
  double largest_stress = 0;            ///< |axial| + |bending| at the edge [Pa]
  Eigen::Vector2d joint1, joint2, tip;  ///< [m]
  double wing_rotation = 0;             ///< of the wing at joint 2 [rad]
  double gap = 0;                       ///< largest violation of H q = h [m]
  bool stable = false;                  ///< a minimum among all q with H q = h
  int iterations = 0;
};

/// First derivatives of a state with respect to X, by four solves with the saddle-point matrix.
struct ElasticSensitivity {
  Eigen::Matrix<double, 2, 4> joint1, joint2, tip;  ///< [1]
  Eigen::RowVector4d wing_rotation;                 ///< [1/m]
  Eigen::RowVector4d energy;                        ///< [J/m]
};

class ElasticLinkage {
 public:
  /// @throws common::Error for a linkage, bars or settings that make no sense
  ElasticLinkage(const FourBar& bar, const WingBars& bars, const ElasticSettings& settings = {});
  ~ElasticLinkage();
  ElasticLinkage(ElasticLinkage&&) noexcept;

  /// Equilibrium at theta [rad]. @param guess  state to start from; null: the rigid position where it exists
  ElasticState solve(double theta, const ElasticState* guess = nullptr) const;
  /// Equilibria at increasing theta, each from the rigid position, or from the one before where bars do not reach.
  std::vector<ElasticState> trace(const std::vector<double>& thetas) const;

  /// dL/dX of any L(q, X) through the equilibrium, by one adjoint solve.
  /// @param L_q  dL/dq at fixed X (size of q); @param L_X  dL/dX at fixed q
  Eigen::Vector4d adjoint(const ElasticState& state, const Eigen::VectorXd& L_q, const Eigen::Vector4d& L_X) const;
  ElasticSensitivity sensitivity(const ElasticState& state) const;

  /// Energy and its derivatives at any q: for tests and for objectives that hold the energy.
  struct Terms {
    double energy = 0;
    Eigen::VectorXd gradient;                        ///< dE/dq
    Eigen::MatrixXd hessian;                         ///< d2E/dq2
    Eigen::Vector4d by_X = Eigen::Vector4d::Zero();  ///< dE/dX at fixed q
    Eigen::Matrix<double, Eigen::Dynamic, 4> mixed;  ///< d2E/dq dX
  };
  Terms terms(const Eigen::VectorXd& q) const;

  int unknowns() const;
  const Eigen::MatrixXd& joints() const;  ///< H
  /// Rows of the tip's displacement and of the wing's rotation at joint 2 in q.
  int tipIndex() const;
  int rotationIndex() const;

 private:
  struct Model;
  class Newton;
  std::unique_ptr<Model> model_;
};

}  // namespace snapwing::design
