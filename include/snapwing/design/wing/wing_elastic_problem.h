#pragma once
/// The wing design with elastic bars: the paper's problem with its gradient through the constrained equilibrium.
/// Tips, joints and stored energy of both driven states come from a rung of linkage_model.h, the objective's gradient
/// from one adjoint solve per state, the constraints' from four direct solves. Bar lengths and transmission angle
/// belong to the rest layout and stay those of the rigid rung. About 5 ms per evaluation with beams, 60 ms with solids.

#include "snapwing/design/wing/linkage_elastic.h"
#include "snapwing/design/wing/linkage_solid.h"
#include "snapwing/design/wing/wing_problem.h"

namespace snapwing::design {

class ElasticWingProblem : public WingProblem {
 public:
  /// @param rung  makes the elastic linkage of a layout; by default beams
  explicit ElasticWingProblem(const WingSettings& settings, LinkageFactory rung = nullptr);
  /// Where an equilibrium is not found, the objective is infinite and the run that asked ends there.
  WingEvaluation evaluate(const Eigen::Vector4d& X, bool with_derivatives) const override;

 private:
  void add(const LinkageModel& linkage, const ElasticState& state, int i, bool derivatives, WingEvaluation* e) const;
  void addSecond(const LinkageModel& linkage, const ElasticState& state, bool derivatives, WingEvaluation* e) const;
  RigidWingProblem rigid_;
  LinkageFactory rung_;
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
RungComparison compareRungs(const LinkageModel& elastic, const std::vector<double>& arm_rotation);

/// Factories for the two elastic rungs.
LinkageFactory beamRung(const WingBars& bars, const ElasticSettings& settings = {});
LinkageFactory solidRung(const WingBars& bars, const SolidSettings& settings = {});

}  // namespace snapwing::design
