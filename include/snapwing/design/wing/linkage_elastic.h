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
/// The same linkage as solids on the mpm layer: linkage_solid.h.

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "snapwing/design/wing/linkage_model.h"

namespace snapwing::design {

struct ElasticSettings {
  int elements_per_bar = 6;      ///< 1 .. 200
  double overhang = 0.08;        ///< bars reach beyond a free joint by this share of their length; 0: joint on a node
  double driver_length = 0.060;  ///< [m] P lies this far inward of the axle; the arm as a straight bar
  JointSolver solver = JointSolver::MULTIPLIERS;
  int max_iterations = 60;
  std::vector<GroundPin> ground_pins;
  void validate() const;
};

class ElasticLinkage : public LinkageModel {
 public:
  /// @throws common::Error for a linkage, bars or settings that make no sense
  ElasticLinkage(const FourBar& bar, const WingBars& bars, const ElasticSettings& settings = {});
  ~ElasticLinkage() override;
  ElasticLinkage(ElasticLinkage&&) noexcept;

  ElasticState solve(double theta, const ElasticState* guess = nullptr) const override;
  ElasticSensitivity sensitivity(const ElasticState& state) const override;
  Eigen::Vector4d gradient(const ElasticState& state, const StateSlopes& L) const override;
  const FourBar& layout() const override;
  int unknowns() const override;

  /// dL/dX of any L(q, X) through the equilibrium, by one adjoint solve.
  /// @param L_q  dL/dq at fixed X (size of q); @param L_X  dL/dX at fixed q
  Eigen::Vector4d adjoint(const ElasticState& state, const Eigen::VectorXd& L_q, const Eigen::Vector4d& L_X) const;

  /// Energy and its derivatives at any q: for tests and for objectives that hold the energy.
  struct Terms {
    double energy = 0;
    Eigen::VectorXd gradient;                        ///< dE/dq
    Eigen::MatrixXd hessian;                         ///< d2E/dq2
    Eigen::Vector4d by_X = Eigen::Vector4d::Zero();  ///< dE/dX at fixed q
    Eigen::Matrix<double, Eigen::Dynamic, 4> mixed;  ///< d2E/dq dX
  };
  Terms terms(const Eigen::VectorXd& q) const;

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
