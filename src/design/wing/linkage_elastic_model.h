#pragma once
/// Inside of ElasticLinkage: what the solver and the sensitivities share.

#include <Eigen/LU>

#include "linkage_beam.h"
#include "snapwing/design/wing/linkage_elastic.h"

namespace snapwing::design {

struct ElasticLinkage::Model {
  Model(const FourBar& bar, const WingBars& bars, const ElasticSettings& settings);

  FourBar bar;
  WingBars bars;
  ElasticSettings settings;
  BeamSection section;
  BeamMesh mesh;
  JointRows rows;
  double row_scale = 1;  ///< [N/m] brings the rows of H to the size of the stiffness
  int rank = 0;          ///< of H
  Eigen::MatrixXd free;  ///< orthonormal basis of the null space of H, for the check of stability

  int size() const { return 3 * static_cast<int>(mesh.nodes.size()); }
  Eigen::Vector2d restOf(int node) const;
  /// Right-hand side h(theta) of the joints' rows.
  Eigen::VectorXd driven(double theta) const;
  /// Friction moments at the pins against the rigid rung's motion; zero where the rigid loop does not close.
  Eigen::VectorXd friction(double theta) const;
  /// Every body moved rigidly as the rigid rung has it; false if the loop does not close.
  bool rigidGuess(double theta, Eigen::VectorXd* q) const;
  /// Six element variables of linkage_beam.h.
  Eigen::Matrix<double, 6, 1> elementVariables(const BeamElement& e, const Eigen::VectorXd& q) const;
  /// Energy, gradient, Hessian; with_X adds by_X and mixed.
  Terms terms(const Eigen::VectorXd& q, bool with_X) const;
  /// [K S H^T; S H 0] with S = row_scale; symmetric, indefinite.
  Eigen::PartialPivLU<Eigen::MatrixXd> saddle(const Eigen::MatrixXd& K) const;
  /// Is K positive definite along the joints (on the null space of H)?
  bool minimum(const Eigen::MatrixXd& K) const;
  Eigen::Vector2d displacement(const Attachment& at, const Eigen::VectorXd& q) const;
  /// Fills everything that follows from q.
  void describe(ElasticState* state) const;
};

}  // namespace snapwing::design
