#pragma once
/// A trial as a YAML file states it: which vehicle, what surrounds it, the pulse, and how finely it is computed. SI.
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
  PLANAR,      ///< one arm in plane stress
  VOLUMETRIC,  ///< one arm as a solid, half of it by symmetry
};
std::string rungName(TrialRung rung);

/// Stick or steady thrust, for a time.
struct TrialLevel {
  double throttle = 0;  ///< stick [0, 1]; negative: `thrust` is given
  double thrust = 0;    ///< steady thrust / full thrust [0, 1]
  double duration = 0;  ///< [s]
};

/// What differs between the repeats of a trial; each is drawn evenly.
struct TrialVariation {
  int seed = 0;
  double strength = 0;   ///< [1] half width of each level's throttle or thrust, as a share of it
  double duration = 0;   ///< [s] half width of each level's duration
  bool vehicle = false;  ///< draw a vehicle from the uncertainty box, too
};

struct TrialFile {
  std::string name, file, sha256, vehicle_file;
  TrialRung rung = TrialRung::PLANAR;
  vehicle::Trial trial;
  std::string mount;
  vehicle::Mode start = vehicle::Mode::FIXED_WING;
  TrialLevel pulse;
  std::vector<TrialLevel> then;  ///< right behind the pulse, one after the other
  std::vector<double> box;       ///< coordinates in [-1, 1] of vehicle::uncertainNames(); empty: nominal
  SchemeKind scheme = SchemeKind::MIDPOINT;
  int points = 2;   ///< of the average force
  double bias = 0;  ///< of the midpoint
  StepperSettings steps;
  AxisSettings axis;
  bool six = false;  ///< degrees of freedom; else along the thrust axis
  SpaceSettings space;
  int repeats = 1;
  TrialVariation vary;
};

/// One of a trial's repeats, by seed and index alone. @param index  0 .. repeats - 1
TrialFile repeatOf(const TrialFile& file, int index);
/// A vehicle of the box by its seed: coordinates in [-1, 1] of vehicle::uncertainNames(), then of the material's
/// memory.
void drawVehicle(int seed, TrialFile& out);

/// @throws common::FileError, common::SettingError naming key, value and range
TrialFile loadTrial(const std::string& path);

}  // namespace snapwing::motion
