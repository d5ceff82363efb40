#pragma once
/// Sensitivities of a scene in D dimensions (internal to the layer).

#include <string>

#include "scene_cells.h"
#include "scene_weight.h"
#include "snapwing/common/loan.h"
#include "snapwing/scene/scene_problem.h"
#include "snapwing/scene/scene_sensitivity.h"
#include "snapwing/solver/load_term.h"
#include "snapwing/solver/sensitivity.h"

namespace snapwing::scene {

/// What a compiled scene, which lends itself for that, shares with its sensitivities.
template <int D>
struct SensitivityParts {
  common::Loan<const CompiledScene> whole;
  const Scene& scene;
  const Mirror& mirror;
  const solver::TermProblem& problem;
  const mpm::Discretisation<D>& solid;
  const solver::LoadTerm& loads;
  const Weight<D>& weight;
  /// Gradients of the monitors by the nodal displacements at the equilibrium, (dofs x monitors).
  Eigen::MatrixXd monitors;
};

template <int D>
class SceneSensitivityOf : public SceneSensitivity {
 public:
  /// @throws common::Error if the Hessian is singular there, or if a joint lies so close to the edge of a body that it
  /// cannot be moved
  SceneSensitivityOf(SensitivityParts<D> parts, const solver::Equilibrium& x);

  const std::vector<int>& joints() const override { return joints_; }
  SceneSlope reaction() const override;
  SceneSlope potential() const override;
  SceneSlope compliance() const override;
  SceneSlope volume() const override;
  SceneSlope monitor(int number) const override;

 private:
  void moveJoints();
  /// d(rows, control, constant) of the kept equations by a joint's coordinate.
  solver::LinearRows movedRows(int joint, int axis) const;
  /// Total derivative of a functional of the displacements: `gradient` by the nodes, at fixed theta.
  SceneSlope functional(const Eigen::VectorXd& gradient) const;

  SensitivityParts<D> parts_;
  const solver::Equilibrium x_;
  solver::Cholesky cholesky_;
  solver::TangentSystem system_;
  solver::Sensitivity adjoint_;
  solver::Variation tangent_;
  Eigen::VectorXd force_;  ///< of the kept equations: lambda + rho g
  std::vector<int> joints_;
  std::vector<solver::LinearRows> rows_;  ///< two per joint
};

}  // namespace snapwing::scene
