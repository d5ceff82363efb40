#pragma once
/// A vehicle's arm as a scene: in the plane or as a solid, with either kernel. What is driven is the travel u of the
/// housing, positive downwards in arm coordinates.

#include "snapwing/mpm/density_field.h"
#include "snapwing/scene/scene.h"
#include "snapwing/vehicle/vehicle.h"

namespace snapwing::scene {

struct ArmSceneSettings {
  int dimension = 2;
  elasticity::Plane plane = elasticity::Plane::STRESS;
  SceneKernel kernel = SceneKernel::LINEAR;
  double cell_size = 0;  ///< [m]; 0: that of the field
  double from = 0;       ///< [m] <= 0: the path leads 0 -> from as well
  double to = 0;         ///< [m] 0 -> to -> 0; 0: to the vehicle's largest travel
  double step = 0.001;   ///< [m] of the path, at most
  bool back = true;
  /// Of from, to and step. @throws common::Error for a path of less than three steps
  void validate() const;
};

/// One body "arm" with the field's cells, extruded to leg_thickness for x < leg_width and bar_thickness beyond; line
/// pin at the axle; port "housing" that drives the leg's face down; one monitor: the rotation about the axle,
/// that which fits the nodes within 4 mm of it best (least squares), positive as u grows.
Scene armScene(const vehicle::Vehicle& vehicle, const mpm::DensityField& field, const ArmSceneSettings& settings);

}  // namespace snapwing::scene
