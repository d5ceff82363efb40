#pragma once
/// Settings of the wing design: what the paper gives, and with stated defaults what it leaves open.
/// Frame of all points: see linkage_four_bar.h (origin at the arm's axle, x outward, y up).

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>

#include "snapwing/common/settings_reader.h"
#include "snapwing/design/wing/wing_arm_motion.h"

namespace snapwing::design {

/// One driven state: when the arm has turned by `arm_rotation`, the tip should have turned by `wing_rotation`.
struct WingTarget {
  double arm_rotation = 0;   ///< [rad] > 0
  double wing_rotation = 0;  ///< [rad] > 0, about rotation_centre, in the sense of wing_sign
};

struct WingBox {
  Eigen::Vector2d low, high;  ///< [m]
};

/// Bars, pins and what resists them; the elastic rung and the parts read these.
struct WingBars {
  double youngs_modulus = 3.0e9;    ///< [Pa] PLA
  double poisson_ratio = 0.36;      ///< [1]
  double mass_density = 1240;       ///< [kg/m3]
  double width = 0.010;             ///< [m] of a bar, in the plane
  double thickness = 0.004;         ///< [m] of a bar, across the plane
  double pin_diameter = 0.003;      ///< [m]
  double friction_moment = 2.0e-4;  ///< [N m] at each of the four pins, against the motion
  double friction_unevenness = 0;   ///< [1] the left wing has (1 + e) times that moment, the right one (1 - e)
};

/// The blade: a fan of four panels about joint 2 between the leading edge and an anchor bar.
struct WingBladeSettings {
  double rod_diameter = 0.008;       ///< [m] leading edge
  double rod_density = 1600;         ///< [kg/m3] carbon fibre
  double film_thickness = 0.000127;  ///< [m] 0.005 inch PET
  double film_density = 1380;        ///< [kg/m3]
  double rib_width = 0.006;          ///< [m] ribs under the folds beside panels two and three
  double rib_thickness = 0.003175;   ///< [m] 1/8 inch PETG
  double rib_density = 1270;         ///< [kg/m3]
  double folded_span = 0.20;         ///< [rad] angle left between leading edge and anchor in the largest state
  double slack = 0.02;               ///< [rad] by which the four panels together exceed the widest fan
};

/// How bars and rod may be stacked (wing_stack.h).
struct WingStackSettings {
  int most_layers = 6;       ///< 1 .. 8
  double gap = 0.0005;       ///< [m] between layers: a washer
  double clearance = 0.001;  ///< [m] that moving parts keep from each other in the plane
  /// @throws common::SettingError naming the key
  void validate() const;
};

struct WingSettings {
  std::string name;
  std::string file;                      ///< where it was read from; empty if built in code
  std::string vehicle_file;              ///< absolute path
  std::vector<std::string> named_files;  ///< that the settings file names
  std::string rung = "rigid";            ///< bars that the design is made on: rigid, elastic (beams) or solid

  Eigen::Vector2d auxiliary_joint{0.035, 0.020};
  Eigen::Vector2d rotation_centre{0.055, 0.020};
  int crank_sign = 1;         ///< sense in which the arm turns as u grows: +1 counter-clockwise
  int wing_sign = 1;          ///< sense in which the wing folds
  double tip_radius = 0.100;  ///< [m] of the tip at rest about rotation_centre; not given in the paper
  double tip_direction = 0;   ///< [rad] of the tip at rest from rotation_centre; not given in the paper
  std::array<WingTarget, 2> targets{{{0.83, 2.45}, {0.93, 2.46}}};

  double separation = 0.012;          ///< s1 [m] least distance of joints 1 and 2
  double wall_joint2_x = 0.045;       ///< s2 [m] least x of joint 2 in state 2
  double wall_joint1_y = 0.060;       ///< s3 [m] largest y of joint 1 in state 2
  double transmission_margin = 0.25;  ///< [rad] least transmission angle from rest to state 2
  double min_bar_length = 0.012;      ///< [m] of crank and rocker
  WingBox joint1_box{{-0.09, -0.09}, {0.09, 0.09}};
  WingBox joint2_box{{-0.09, -0.09}, {0.12, 0.09}};

  double compliance_weight = 10;  ///< alpha [m2/J]; acts on the elastic rung only
  double rotation_weight = 0.02;  ///< [m/rad] weight of the wing's own rotation error; 0: the paper's objective
  double dwell_weight = 0.0;      ///< [m/rad] weight of the wing's motion between the states beyond the wanted one

  int samples = 40000;  ///< random layouts of the global start
  int starts = 24;      ///< best of them that are optimised
  int seed = 7;
  int evaluations = 400;                  ///< per local run
  std::string optimizer = "nlopt_slsqp";  ///< nlopt_mma, nlopt_slsqp or own_mma

  WingBars bars;
  WingBladeSettings blade;
  WingStackSettings stack;
  std::optional<ArmMotion> motion;  ///< always set by loadWingSettings

  Eigen::Vector2d tipAtRest() const;  ///< [m] in the linkage frame
  /// Where the tip should be in state i = 0, 1. [m]
  Eigen::Vector2d tipTarget(int i) const;
  /// Wing rotation wanted in state i, counter-clockwise positive. [rad]
  double wantedRotation(int i) const { return wing_sign * targets[i].wing_rotation; }
  /// @throws common::Error naming key, value and allowed range
  void validate() const;
};

/// Reads config/designs/wing_*.yaml strictly. @throws common::FileError, common::SettingError
WingSettings loadWingSettings(const std::string& path);

}  // namespace snapwing::design
