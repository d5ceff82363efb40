#pragma once
/// The wing design with elastic bars: the paper's problem with its gradient through the constrained equilibrium.
/// Tips, joints and stored energy of both driven states come from linkage_elastic.h, the objective's gradient from one
/// adjoint solve per state, the constraints' from four direct solves. Bar lengths and transmission angle belong to the
/// rest layout and stay those of the rigid rung. About 5 ms per evaluation.

#include "snapwing/design/linkage_elastic.h"
#include "snapwing/design/wing_problem.h"

namespace snapwing::design {

class ElasticWingProblem : public WingProblem {
 public:
  explicit ElasticWingProblem(WingSettings settings, ElasticSettings elastic = {})
      : WingProblem(settings), rigid_(std::move(settings)), elastic_(std::move(elastic)) {}
  /// Where an equilibrium is not found, the objective is infinite and the run that asked ends there.
  WingEvaluation evaluate(const Eigen::Vector4d& X, bool with_derivatives) const override;

 private:
  void add(const ElasticLinkage& linkage, const ElasticState& state, int i, WingEvaluation* e) const;
  void addSecond(const ElasticLinkage& linkage, const ElasticState& state, bool derivatives, WingEvaluation* e) const;
  RigidWingProblem rigid_;
  ElasticSettings elastic_;
};

/// Elastic against rigid over the travel: what the rigid rung leaves out.
struct RungComparison {
  bool converged = false;
  std::string message;
  std::vector<double> arm_rotation;   ///< [rad]
  std::vector<double> stored_energy;  ///< [J]
  double largest_tip_error = 0;       ///< [m]
  double largest_rotation_error = 0;  ///< [rad]
  double largest_energy = 0;          ///< [J]
  double largest_stress = 0;          ///< [Pa]
  bool same_branch = true;            ///< every elastic state is on the branch of rest
  bool stable = true;
  double seconds_per_state = 0;
};
RungComparison compareRungs(const FourBar& bar, const WingBars& bars, const std::vector<double>& arm_rotation,
                            const ElasticSettings& elastic = {});

}  // namespace snapwing::design
