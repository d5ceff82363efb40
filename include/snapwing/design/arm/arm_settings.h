#pragma once
/// Settings of the design of a bistable arm, or of another mechanism with one driven travel; read strictly from
/// config/designs/arm_*.yaml. SI; forces are per ARM except those of `targets`.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "snapwing/elasticity/material.h"
#include "snapwing/scene/scene.h"
#include "snapwing/vehicle/vehicle.h"

namespace snapwing::design {

/// One part of a run: a discretisation and its iterations, started from the stage before.
struct ArmStage {
  bool volumetric = false;   ///< a solid, columns of cells along z share their density; else planar
  double cell_size = 0.001;  ///< [m]
  int iterations = 120;
  double move = 0.05;  ///< largest change of a variable in one iteration
};

/// What the check asks of every body beside bistability; what a file does not name is not asked. Forces are totals of
/// all copies.
struct ArmTargets {
  using Interval = std::optional<std::array<double, 2>>;
  Interval peak;             ///< [N]
  Interval valley;           ///< [N]
  Interval second;           ///< [m] second stable equilibrium
  Interval rotation;         ///< [rad] there
  double hysteresis = 0.01;  ///< share of the peak
};

struct ArmDesignSettings {
  std::string name, file;
  std::vector<std::string> named_files;  ///< that are read: the vehicle's, or the scene's and all that it names
  vehicle::Vehicle vehicle;              ///< gives domain, ports, thickness, material, unless there is a scene
  bool user_scene = false;               ///< the mechanism is `scene`, with the density of `body` to be designed
  scene::Scene scene;
  int body = 0;
  int copies = 4;             ///< equal mechanisms that act together
  double travel_max = 0.1;    ///< [m] end of the checked path
  std::string inputs_sha256;  ///< of the files, for hash()

  std::vector<ArmStage> stages{{}};
  elasticity::Plane plane = elasticity::Plane::STRESS;
  int threads = 1;  ///< at most; the result does not depend on it

  double filter_radius = 0.0035;                    ///< [m]
  double sharpness_start = 1, sharpness_end = 16;   ///< of the projection
  double sharpness_from = 0.4, sharpness_to = 0.9;  ///< shares of all iterations between which it grows
  std::vector<double> thresholds{0.5};              ///< one design for all of them; the first is the nominal one
  double pin_patch = 0.004, clamp_patch = 0.0;      ///< [m] solid disc around a pin; solid depth behind a port's face
  double void_threshold = 0.01;  ///< stiffness share below which a cell counts as void: linear energy there

  double start_density = 0.9;
  double volume = 0.5;         ///< bound, share of the domain's area
  double volume_start = 0.95;  ///< bound at the first iteration
  double volume_until = 0.5;   ///< share of all iterations at which it has come down

  double peak_travel = 0.010;                          ///< [m] objective: mean of R over valley_range - R(peak_travel)
  std::array<double, 2> valley_range{{0.044, 0.044}};  ///< [m] equal ends: R there
  double compliance_weight = 1;                        ///< alpha, times f |u3| [N] per [J]
  double compliance_force = 1;                         ///< [N] pulled against the snap; 0: no such term
  std::vector<double> peak_travels{0.010};             ///< [m] where R <= peak_bound
  double peak_bound = 1.0;                             ///< [N]
  double peak_share_least = 0;                         ///< R(peak_travel) >= this share of peak_bound; 0: no such bound
  std::vector<double> valley_travels{0.034, 0.040, 0.044, 0.048};  ///< [m] where R >= -valley_bound
  double valley_bound = 0.3;                                       ///< [N]
  std::vector<double> slope_travels;  ///< [m] between neighbours of these the force falls by at most ...
  double slope_bound = 60;            ///< [N/m]
  /// [rad] at rotation_travels, as the check measures it
  std::array<double, 2> rotation_bound{0, 0};
  std::vector<double> rotation_travels;  ///< [m]; empty: no such bound
  double mass_limit = 0;                 ///< [kg] of one arm; 0: none
  double strain_limit = 0;               ///< [1] of the aggregated largest principal strain; 0: none
  std::vector<double> strain_travels;    ///< [m] where it is looked at
  double strain_power = 12;              ///< of the aggregation

  std::string optimizer = "mma";  ///< mma, gcmma, nlopt

  std::vector<double> check_cells{0.001, 0.0005};  ///< [m] of the post-check
  double check_offset = 0.0002;                    ///< [m] printing error that the design is checked with
  double check_step = 0.001;                       ///< [m]
  std::vector<double> check_quadratic_cells;       ///< [m] of the check with the B-spline kernel; may be empty
  std::vector<double> check_volumetric_cells;      ///< [m] of the check as a solid; may be empty
  double check_volumetric_step = 0.002;            ///< [m]
  ArmTargets targets;

  /// Iterations of all stages.
  int iterations() const;
  /// False: a scene without a monitor of a rotation, so that it is not bounded.
  bool turns() const;
  /// Hash of everything that the result depends on.
  std::string hash() const;
};

/// @param vehicle_file  in place of the one that the settings name; empty: that one
/// @throws common::SettingError naming key, value and what is allowed; FileError
ArmDesignSettings loadArmDesignSettings(const std::string& path, const std::string& vehicle_file = {});

}  // namespace snapwing::design
