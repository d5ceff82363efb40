#include "arm_bodies.h"

#include <algorithm>
#include <type_traits>

#include "snapwing/mpm/cell_values.h"
#include "snapwing/scene/arm_scene.h"

namespace snapwing::motion {

scene::Scene armBodies(const vehicle::Vehicle& vehicle, double force_scale, const AxisSettings& settings,
                       const elasticity::PronySeries& series, const std::vector<double>& shares) {
  const vehicle::ArmSettings& arm = vehicle.arm;
  mpm::DensityField field = mpm::loadDensityCsv(arm.density_file, arm.domain_length, arm.domain_height);
  if (settings.cell_size > 0) field = field.resampled(settings.cell_size, mpm::coarseningPower(settings.coarsening));
  for (double& value : field.value) {
    if (value < settings.least_density) value = -1;
  }
  scene::ArmSceneSettings of;
  of.dimension = settings.dimension;
  of.kernel = settings.kernel;
  scene::Scene scene = scene::armScene(vehicle, field, of);
  scene.monitors[0].radius = settings.hub_radius;
  if (settings.in_space) scene.interpolation.threshold = 1e-4, scene.interpolation.sharpness = 5e5;
  if (settings.whole_thickness) scene.use_symmetry = scene::SymmetryUse::NONE;
  // The scale of the real force is one of the modulus: the law is linear in it.
  scene.bodies[0].material.youngs_modulus *= force_scale;
  // The solid's own law is the slow one.
  if (vehicle.material.relaxation.modulus_is_fast) scene.bodies[0].material.youngs_modulus *= series.slow();
  for (std::size_t k = 1; k < shares.size(); ++k) {
    const std::string number = " " + std::to_string(k + 1);
    const auto again = [&](auto& list) {
      auto one = list.front();
      one.name += number;
      if constexpr (std::is_same_v<std::decay_t<decltype(one)>, scene::SceneBody>) {
        one.material.youngs_modulus *= shares[k];
        one.material.mass_density *= shares[k];
      } else {
        one.body = static_cast<int>(k);
      }
      list.push_back(std::move(one));
    };
    again(scene.bodies);
    again(scene.pins);
    again(scene.ports);
    again(scene.monitors);
  }
  return scene;
}

ArmStrain::ArmStrain(const scene::CompiledScene& arms)
    : arms_(arms),
      means_(arms.planar() != nullptr ? mpm::meansWithin(*arms.planar(), mpm::STRAIN_RADIUS)
                                      : mpm::meansWithin(*arms.volumetric(), mpm::STRAIN_RADIUS)) {}

void ArmStrain::record(const Eigen::VectorXd& displacements, AxisSample& out) const {
  const Eigen::VectorXd strains = arms_->planar() != nullptr ? mpm::cellStrains(*arms_->planar(), displacements)
                                                             : mpm::cellStrains(*arms_->volumetric(), displacements);
  out.strain = strains.maxCoeff();
  out.mean_strain = (means_ * strains).maxCoeff();
}

bool ofAxle(const scene::CompiledScene& arms, int dof) {
  const mpm::Discretisation<3>* solid = arms.volumetric();
  if (solid == nullptr || dof % 3 != 0) return false;
  // The clamp is at the inner end, the axle at the outer one.
  double farthest = 0;
  for (int node = 0; node < solid->nodeCount(); ++node) farthest = std::max(farthest, solid->position(node)(0));
  return solid->position(dof / 3)(0) > 0.5 * farthest;
}

solver::Equation alongAxle(const solver::Reduction& arms, int dof) {
  solver::Equation equation;
  equation.name = "an arm's axle";
  equation.terms.emplace_back(dof + 2, 1.0);
  for (const auto& [z, factor] : arms.terms(dof)) equation.terms.emplace_back(arms.dofOfFree(z) + 2, -factor);
  return equation;
}

}  // namespace snapwing::motion
