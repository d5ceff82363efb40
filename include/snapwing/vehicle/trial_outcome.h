#pragma once
/// Outcome of a trial, for all models.

#include <limits>

#include "snapwing/vehicle/mode.h"

namespace snapwing::vehicle {

struct TrialOutcome {
  Mode start_mode = Mode::UNKNOWN;
  Mode end_mode = Mode::UNKNOWN;  ///< UNKNOWN = not at rest within the horizon
  bool snapped = false;           ///< end mode is the other stable mode
  bool start_held = true;         ///< the start mode is an equilibrium under the initial loads
  double snap_time = std::numeric_limits<double>::quiet_NaN();    ///< [s] after the command, last crossing of the
                                                                  ///< unloaded barrier; NaN = none
  double settle_time = std::numeric_limits<double>::quiet_NaN();  ///< [s] after the command; NaN = not at rest
  double peak_travel = 0, least_travel = 0, end_travel = 0;       ///< [m] largest, smallest and last u
  double end_speed = 0;                                           ///< [m/s] of the common centre of mass
  double peak_speed = 0;                                          ///< [m/s] largest |speed| of the ring
  int steps = 0;
};

}  // namespace snapwing::vehicle
