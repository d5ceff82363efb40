#pragma once
/// What the lumped model says of a pulse.

#include <limits>
#include <string>

#include "snapwing/vehicle/mode.h"

namespace snapwing::rom {

/// Answer of the lumped model; the members follow msg/SnapPrediction.msg. docs/reduced_model.md defines the margin.
struct SnapPrediction {
  std::string rung = "lumped";
  vehicle::Mode start_mode = vehicle::Mode::UNKNOWN;
  vehicle::Mode end_mode = vehicle::Mode::UNKNOWN;                ///< UNKNOWN = not settled within the horizon
  bool snapped = false;                                           ///< end mode is the other stable mode
  double snap_time = std::numeric_limits<double>::quiet_NaN();    ///< [s] after the command, last crossing; NaN = none
  double peak_travel = 0;                                         ///< [m]
  double least_travel = 0;                                        ///< [m]
  double end_travel = 0;                                          ///< [m]
  double end_speed = 0;                                           ///< [m/s] of the common centre of mass
  double peak_speed = 0;                                          ///< [m/s] largest |speed| of the ring
  double settle_time = std::numeric_limits<double>::quiet_NaN();  ///< [s] after the command; NaN = not settled
  double energy_margin = std::numeric_limits<double>::quiet_NaN();  ///< [1] > 0: the switch happens and holds
  double force_error = std::numeric_limits<double>::quiet_NaN();    ///< [N]
  bool out_of_table = false;
  bool start_held = true;  ///< the start mode is an equilibrium under the initial loads
  int steps = 0;
  double compute_seconds = 0;  ///< wall time, filled by callers that measure it
};

}  // namespace snapwing::rom
