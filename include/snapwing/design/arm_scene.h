#pragma once
/// An arm's density as a scene of the statics floor: in the plane or as a solid, with either kernel.

#include "snapwing/common/vehicle.h"
#include "snapwing/mpm/density_field.h"
#include "snapwing/statics/scene.h"

namespace snapwing::design {

struct ArmSceneSettings {
  int dimension = 2;
  elasticity::Plane plane = elasticity::Plane::STRESS;
  statics::SceneKernel kernel = statics::SceneKernel::LINEAR;
  double step = 0.001;  ///< [m] of the path, 0 -> the vehicle's largest travel -> 0
  bool back = true;
};

/// One body "arm" with the field's cells, extruded to leg_thickness for x < leg_width and bar_thickness beyond; line
/// pin at the axle; port "housing" that drives the leg's face down; one monitor: the rotation about the axle.
statics::Scene armScene(const common::Vehicle& vehicle, const mpm::DensityField& field,
                        const ArmSceneSettings& settings);

}  // namespace snapwing::design
