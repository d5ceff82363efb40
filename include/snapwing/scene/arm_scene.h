#pragma once
/// A vehicle's arm as a scene, planar or volumetric. The control is the travel u of the housing [m], positive downwards
/// (-y) in arm coordinates.

#include "snapwing/mpm/density_field.h"
#include "snapwing/scene/scene.h"
#include "snapwing/vehicle/vehicle.h"

namespace snapwing::scene {

struct ArmSceneSettings {
  int dimension = 2;
  elasticity::Plane plane = elasticity::Plane::STRESS;
  SceneKernel kernel = SceneKernel::LINEAR;
  double cell_size = 0;  ///< [m]; 0: that of the field
  double from = 0;       ///< [m] <= 0: also traces 0 -> from
  double to = 0;         ///< [m] end of the path; 0: the vehicle's limits.travel_max
  double step = 0.001;   ///< [m] largest step of the path
  bool back = true;      ///< also traces to -> 0
  /// Checks from, to (> 0 here) and step. @throws common::Error, also for a path of less than three steps
  void validate() const;
};

/// One body "arm" with the field's density, leg_thickness thick for x < leg_width and bar_thickness beyond. A line pin
/// at the axle. The port "housing" drives the face x = 0 between the clamp heights downwards. One monitor, the rotation
/// about the axle: least-squares fit over the nodes within 4 mm, positive as u grows.
/// @param field  resampled if settings.cell_size is not its own. @throws common::Error (DensityField::resampled)
Scene armScene(const vehicle::Vehicle& vehicle, const mpm::DensityField& field, const ArmSceneSettings& settings);

}  // namespace snapwing::scene
