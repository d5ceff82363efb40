#pragma once
/// Contents of a trial's YAML file: the vehicle, its surroundings, the pulse, fidelity and time integration. SI units.
/// Schema: docs/motion.md.

#include <string>
#include <vector>

#include "snapwing/motion/axis_vehicle.h"
#include "snapwing/motion/space_vehicle.h"
#include "snapwing/vehicle/mode.h"
#include "snapwing/vehicle/trial.h"

namespace snapwing::motion {

enum class TrialRung {
  LUMPED,      ///< tables (rom)
  PLANAR,      ///< arms in plane stress
  VOLUMETRIC,  ///< arms as solids, half of the thickness by symmetry where motion is along the axis
};
/// lumped, planar or volumetric.
std::string rungName(TrialRung rung);

/// Stick or steady thrust for a duration.
struct TrialLevel {
  double throttle = 0;  ///< stick [0, 1]; negative: `thrust` is used
  double thrust = 0;    ///< steady thrust / full thrust [0, 1]
  double duration = 0;  ///< [s]
};

/// Variation between the repeats of a trial; uniform distributions.
struct TrialVariation {
  int seed = 0;
  double strength = 0;   ///< [1] half width of each level's throttle or thrust, relative to it
  double duration = 0;   ///< [s] half width of each level's duration
  bool vehicle = false;  ///< also draw a vehicle from the box of uncertainty
};

struct TrialFile {
  std::string name, file, sha256, vehicle_file;
  TrialRung rung = TrialRung::PLANAR;
  vehicle::Trial trial;
  std::string mount;
  vehicle::Mode start = vehicle::Mode::FIXED_WING;
  TrialLevel pulse;
  std::vector<TrialLevel> then;  ///< further levels, directly after the pulse, in order
  std::vector<double> box;       ///< coordinates in [-1, 1] of vehicle::uncertainNames(); empty: nominal
  SchemeKind scheme = SchemeKind::MIDPOINT;
  int points = 2;   ///< Gauss points of AVERAGE_FORCE, 1 .. 4
  double bias = 0;  ///< of MIDPOINT, [0, 0.5] (Scheme)
  StepperSettings steps;
  AxisSettings axis;
  bool six = false;  ///< six degrees of freedom; false: along the thrust axis
  SpaceSettings space;
  int repeats = 1;
  TrialVariation vary;
};

/// One repeat of a trial; depends on seed and index only. @param index  0 .. repeats - 1. @throws common::Error outside
TrialFile repeatOf(const TrialFile& file, int index);
/// Draws a vehicle from the box: coordinates in [-1, 1] of vehicle::uncertainNames(), then relaxation_share and
/// relaxation_time of the material. Equal seeds give equal vehicles.
void drawVehicle(int seed, TrialFile& out);

/// Reads a trial file. @throws common::FileError; common::SettingError naming key, value and range
TrialFile loadTrial(const std::string& path);

}  // namespace snapwing::motion
