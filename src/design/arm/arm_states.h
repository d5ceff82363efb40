#pragma once
/// Equilibria of one variant of an arm design (internal to the layer).

#include <memory>
#include <vector>

#include "snapwing/design/arm/arm_topology.h"
#include "snapwing/solver/newton.h"

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

/// Part of a variant's states with a factor and work space of its own.
struct ArmTopology::Worker {
  Worker(const solver::Problem& problem, double tolerance) : newton(problem, settingsFor(tolerance)) {}
  static solver::NewtonSettings settingsFor(double tolerance) {
    solver::NewtonSettings settings;
    settings.relative_tolerance = tolerance;
    return settings;
  }

  static constexpr int A_VARIANT = 2;  ///< at most

  solver::Newton newton;
  solver::Evaluation at;
  std::size_t first = 0, end = 0;  ///< of the variant's states
  bool with_pulled = false;        ///< the state under the force -f, too
  bool good = false;
  std::string why;
  long newton_iterations = 0;
  double seconds_derivatives = 0;
};

/// One threshold of the projection with a mechanism of its own, so that variants may be solved side by side.
struct ArmTopology::Variant {
  Variant(const scene::Scene& scene, int body, int threads) : mechanism(scene, body, threads) {}

  Mechanism mechanism;
  std::vector<std::unique_ptr<Worker>> workers;
  std::shared_ptr<const Chain> map;
  std::vector<State> states;
  State pulled;  ///< under the force -f
  Eigen::VectorXd density;
  bool good = false, retraced = false;  ///< at the evaluation that runs
  std::string why;
  int retraces = 0;
  long newton_iterations = 0;  ///< of retraces
  double seconds_retrace = 0;
};

}  // namespace snapwing::design
