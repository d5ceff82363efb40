#pragma once
/// What the design of a bistable arm is told, read strictly from config/designs/arm_*.yaml. SI; forces are per ARM.

#include <string>
#include <vector>

#include "snapwing/common/vehicle.h"
#include "snapwing/elasticity/material.h"

namespace snapwing::design {

struct ArmDesignSettings {
  std::string name, file;
  common::Vehicle vehicle;  ///< gives domain, ports, thickness, material

  double cell_size = 0.001;  ///< [m]
  elasticity::Plane plane = elasticity::Plane::STRESS;
  int threads = 1;

  double filter_radius = 0.0035;                    ///< [m]
  double sharpness_start = 1, sharpness_end = 16;   ///< of the projection
  double sharpness_from = 0.4, sharpness_to = 0.9;  ///< shares of the iterations between which it grows
  std::vector<double> thresholds{0.5};              ///< one design for all of them; the first is the nominal one
  double pin_patch = 0.004, clamp_patch = 0.0;      ///< [m] solid disc around the pin; solid depth behind the housing

  double void_threshold = 0.01;  ///< stiffness share below which a cell counts as void: linear energy there

  double start_density = 0.9;
  double volume = 0.5;         ///< bound, share of the L-shaped domain's area
  double volume_start = 0.95;  ///< bound at the first iteration
  double volume_until = 0.5;   ///< share of the iterations at which it has come down

  double peak_travel = 0.010;                                      ///< [m] objective: R(valley_travel) - R(peak_travel)
  double valley_travel = 0.044;                                    ///< [m]
  double compliance_weight = 1;                                    ///< alpha, times f |u3| [N] per [J]
  double compliance_force = 1;                                     ///< [N] pulled against the snap; 0: no such term
  std::vector<double> peak_travels{0.010};                         ///< [m] where R <= peak_bound
  double peak_bound = 1.0;                                         ///< [N]
  std::vector<double> valley_travels{0.034, 0.040, 0.044, 0.048};  ///< [m] where R >= -valley_bound
  double valley_bound = 0.3;                                       ///< [N]
  std::vector<double> slope_travels;  ///< [m] between neighbours of these the force falls by at most ...
  double slope_bound = 60;            ///< [N/m]

  std::string optimizer = "mma";  ///< mma, gcmma, nlopt
  int iterations = 120;
  double move = 0.05;

  std::vector<double> check_cells{0.001, 0.0005};  ///< [m] of the post-check
  double check_offset = 0.0002;                    ///< [m] printing error that the design is checked with
  double check_step = 0.001;                       ///< [m]
  double check_quadratic_cell = 0;                 ///< [m] of the check with the B-spline kernel; 0: none
  double check_volumetric_cell = 0;                ///< [m] of the check as a solid; 0: none
  double check_volumetric_step = 0.002;            ///< [m]

  /// Hash of everything that the result depends on.
  std::string hash() const;
};

/// @throws common::SettingError naming key, value and what is allowed; FileError
ArmDesignSettings loadArmDesignSettings(const std::string& path);

}  // namespace snapwing::design
