#pragma once
/// The mechanism of a design as a scene: in the plane or as a solid, with any kernel and cell
/// size, filled or with a given density.

#include "snapwing/design/arm/arm_settings.h"
#include "snapwing/mpm/density_field.h"
#include "snapwing/scene/scene.h"

namespace snapwing::design {

struct SceneRung {
  bool volumetric = false;  ///< always with the reduced volume term
  bool quadratic = false;   ///< B-spline kernel
  double cell_size = 0.001;
  double step = 0.001;  ///< [m] of the path, 0 -> largest travel -> 0
  double from = 0;      ///< [m] <= 0: and 0 -> from
};

/// A vehicle's arm: one body of the field's cells, leg_thickness for x < leg_width and bar_thickness beyond; line pin
/// at the axle; port "housing" that drives the leg's face down; monitor: rotation about the axle. Otherwise the user's
/// scene.
/// @param field  density of the designed body on the rung's cells; null: its whole domain, full
/// @throws common::Error if the cells do not fit
scene::Scene designScene(const ArmDesignSettings& settings, const SceneRung& rung, const mpm::DensityField* field);

/// The designed body's domain on planar cells, filled with one density. @throws common::Error if cells do not fit
mpm::DensityField designDomain(const ArmDesignSettings& settings, double cell_size, double density);

/// The L-shaped domain of a vehicle's arm. @throws common::Error if cells do not fit
mpm::DensityField armDomain(const vehicle::ArmSettings& arm, double cell_size, double density);

/// A point of the domain that must belong to any design: the axle of an arm, else the first port.
std::array<double, 2> designSeed(const ArmDesignSettings& settings);

/// Columns that the design may not change: discs around the pins and strips behind the ports' faces, 1; else -1.
/// @param centres  of the columns [m]
Eigen::VectorXd designPatches(const ArmDesignSettings& settings, const std::vector<std::array<double, 2>>& centres);

}  // namespace snapwing::design
