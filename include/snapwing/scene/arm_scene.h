#pragma once
/// A vehicle's arm as a scene: in the plane or as a solid, with either kernel.

#include "snapwing/mpm/density_field.h"
#include "snapwing/scene/scene.h"
#include "snapwing/vehicle/vehicle.h"

namespace snapwing::scene {

struct ArmSceneSettings {
  int dimension = 2;
  elasticity::Plane plane = elasticity::Plane::STRESS;
  SceneKernel kernel = SceneKernel::LINEAR;
  double step = 0.001;  ///< [m] of the path, 0 -> the vehicle's largest travel -> 0
  bool back = true;
};

/// One body "arm" with the field's cells, extruded to leg_thickness for x < leg_width and bar_thickness beyond; line
/// pin at the axle; port "housing" that drives the leg's face down; one monitor: the rotation about the axle.
Scene armScene(const vehicle::Vehicle& vehicle, const mpm::DensityField& field, const ArmSceneSettings& settings);

}  // namespace snapwing::scene
