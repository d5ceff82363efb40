#pragma once
/// Equilibria of one variant of an arm design (internal to the design floor).

#include <memory>
#include <vector>

#include "snapwing/design/arm_topology.h"
#include "snapwing/statics/newton.h"

namespace snapwing::design {

/// Equilibrium at one travel with what the optimiser needs of it.
struct ArmTopology::State {
  double travel = 0;
  bool wants_strain = false, wants_rotation = false, wants_potential = false;
  Eigen::VectorXd z;  ///< warm start; empty before the first trace
  double force = 0, stiffness = 0;
  Eigen::VectorXd slope;       ///< dz/du
  Eigen::VectorXd by_density;  ///< dR/drho
  Mechanism::Strain strain;
  Mechanism::Sensed rotation, potential;
};

/// One threshold of the projection with a mechanism of its own, so that variants may be solved side by side.
struct ArmTopology::Variant {
  Variant(const statics::Scene& scene, int body, int threads, double tolerance)
      : mechanism(scene, body, threads), newton(mechanism.problem(), settingsFor(tolerance)) {}
  static statics::NewtonSettings settingsFor(double tolerance) {
    statics::NewtonSettings settings;
    settings.relative_tolerance = tolerance;
    return settings;
  }

  Mechanism mechanism;
  statics::Newton newton;
  std::shared_ptr<const Chain> map;
  std::vector<State> states;
  State pulled;  ///< under the force -f
  Eigen::VectorXd density;
  int retraces = 0;
  long newton_iterations = 0;
};

}  // namespace snapwing::design
