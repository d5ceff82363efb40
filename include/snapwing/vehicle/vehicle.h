#pragma once
/// All numbers of a vehicle, read strictly from config/vehicles/*.yaml. SI units.
/// Convention: u = travel of the housing relative to the ring, 0 in fixed-wing mode, positive in the direction in which
/// thrust moves it.

#include <optional>
#include <string>

#include "snapwing/common/settings_reader.h"

namespace snapwing::vehicle {

struct Masses {
  common::Quantity total;   ///< [kg] whole vehicle, arms included
  common::Quantity centre;  ///< [kg] housing, battery, electronics, without arms; ring side with arms: total - centre
};

/// Dimensions of ring, housing, arms and rotors. [m]
struct Geometry {
  double ring_radius = 0;
  double ring_thickness = 0;
  double ring_width = 0;
  double housing_radius = 0;
  double housing_height = 0;
  double axle_below_ring = 0;
  double rotor_radius = 0;
};

/// One of `count` equal arms. Arm coordinates: x = r - housing_radius outward, y up, origin at the lower inner corner
/// of the design domain; [m].
struct ArmSettings {
  int count = 0;
  double domain_length = 0;  ///< extent in x
  double domain_height = 0;  ///< extent in y
  double leg_width = 0;      ///< x < leg_width is the leg, with leg_thickness
  double bar_height = 0;     ///< y < bar_height is the bar; outside the leg there is material only in the bar
  double leg_thickness = 0;
  double bar_thickness = 0;
  double pin_x = 0, pin_y = 0;               ///< axle
  double clamp_y_low = 0, clamp_y_high = 0;  ///< the housing clamps the face x = 0 between these heights
  std::string density_file;                  ///< absolute path of the shipped design's density [CSV]
  std::string table_file;                    ///< absolute path of the computed force table [HDF5]
  common::Quantity force_scale;              ///< [1] real force / computed force (printing, material)
};

/// Relaxation of the material: after a strain its modulus decreases from the fast to the slow one (Prony series). No
/// terms: no relaxation.
struct Relaxation {
  struct Term {
    common::Quantity share;  ///< [1] of the fast modulus
    common::Quantity time;   ///< [s]
  };
  bool modulus_is_fast = false;  ///< true: youngs_modulus is the fast modulus; false: the slow one
  std::vector<Term> terms;
};

struct Material {
  common::Quantity youngs_modulus;  ///< [Pa]
  common::Quantity poisson_ratio;   ///< [1]
  common::Quantity mass_density;    ///< [kg/m3]
  Relaxation relaxation;
  /// [1] largest principal strain (stretch - 1) that a part withstands once, as a mean over 1 mm; unset: unknown. A
  /// validation compares the mean strain of a switch with it (mpm/cell_values.h). It says nothing about fatigue.
  std::optional<common::Quantity> strain_limit;
};

struct Rotors {
  int count = 0;
  common::Quantity max_thrust;          ///< [N] each, at full motor output and rest
  common::Quantity time_constant_up;    ///< [s] first-order lag while thrust rises
  common::Quantity time_constant_down;  ///< [s] while it falls
  common::Quantity quadratic_share;     ///< [1] thrust fraction = q s^2 + (1-q) s of the motor output s in [0,1]
};

/// For documentation only: no computation uses it. cells = 0 if the file states no battery.
struct Battery {
  int cells = 0;
  common::Quantity capacity;  ///< [A s]
  common::Quantity voltage;   ///< [V] under load
};

struct Drag {
  common::Quantity air_density;  ///< [kg/m3]
  common::Quantity ring_cda;     ///< [m2] drag area of ring side with stopped or windmilling propellers
  common::Quantity centre_cda;   ///< [m2] drag area of the centre
};

/// The boom of a trial with mount "boom"; not needed for free flight. If not given, its mass, drag and friction are 0,
/// and a request for this mount is refused (Vehicle::requireBoom).
struct Boom {
  bool given = false;
  common::Quantity length{1.0, 0};    ///< [m] axis to vehicle
  common::Quantity inertia{0.0, 0};   ///< [kg m2] of the boom alone about its axis
  common::Quantity cda{0.0, 0};       ///< [m2] drag area of the boom, referred to the tip speed
  common::Quantity friction{0.0, 0};  ///< [N] Coulomb friction referred to the tip
};

/// From a command to the motors: radio, scaling by the flight controller, and delay.
struct Radio {
  double frame_rate = 0;     ///< [Hz]
  common::Quantity latency;  ///< [s] command issued -> motor output changed
  double throttle_low = 0;   ///< [us] stick low
  double throttle_high = 0;  ///< [us] stick full
  double min_check = 0;      ///< [us] below: motors at idle
  double motor_idle = 0;     ///< [us] motor output when armed and throttle low
  double motor_full = 0;     ///< [us] full motor output
};

struct Limits {
  double travel_min = 0;  ///< [m] mechanical stop upward (negative)
  double travel_max = 0;  ///< [m] mechanical stop, or end of the computed curve
};

/// The designed wings, if the vehicle has any; absolute paths, empty if not.
struct VehicleWing {
  std::string layout_file;                  ///< wing.yaml of `snapwing design wing`
  std::string table_file;                   ///< its table against u [HDF5]
  common::Quantity inertia_scale{1.0, 0};   ///< [1] real inertia / that of the table
  common::Quantity friction_scale{1.0, 0};  ///< [1] real friction of the pins / that of the table
  /// [N m/rad] stiffness of the taut film against rotation of a wing back past rest; 0: none
  common::Quantity stop{0.0, 0};
};

/// Results computed from the file; absolute paths, empty if the file names none.
struct VehicleResults {
  std::string plan_f_to_q, plan_q_to_f;  ///< plans [JSON] of `snapwing plan`
  std::string validation;                ///< validation.json of `snapwing validate`
};

struct Vehicle {
  std::string name;
  std::string file;    ///< where it was read from
  std::string sha256;  ///< of that file's bytes
  Masses masses;
  Geometry geometry;
  ArmSettings arm;
  Material material;
  common::Quantity damping_ratio;  ///< [1] viscous, of the relative motion at the second equilibrium
  Rotors rotors;
  Battery battery;
  Drag drag;
  Boom boom;
  Radio radio;
  Limits limits;
  VehicleWing wing;
  /// Accidents that the vehicle must survive in a validation: names of planning::accidentMargins.
  std::vector<std::string> must_survive;
  VehicleResults results;

  bool hasWing() const { return !wing.table_file.empty(); }
  /// @param who  asks for the mount "boom"; begins the message @throws SettingError if the vehicle has no boom
  void requireBoom(const std::string& who) const;
};

/// Reads a vehicle file. @throws FileError; SettingError naming key, value and allowed range
Vehicle loadVehicle(const std::string& path);

}  // namespace snapwing::vehicle
