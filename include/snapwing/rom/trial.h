#pragma once
/// What surrounds the vehicle while a pulse runs, and what the lumped model says of the pulse.

#include <limits>
#include <optional>
#include <string>

#include "snapwing/common/mode.h"

namespace snapwing::common {
struct Vehicle;
}

namespace snapwing::rom {

enum class Mount {
  FREE,  ///< flies freely along its thrust axis
  BOOM,  ///< at the end of a boom, thrust tangential: the boom's inertia, drag and friction join the ring side
  HELD,  ///< the ring stands still; only the centre moves
};

/// "free", "boom" or "held". @throws common::Error for another word
Mount mountFromName(const std::string& text);
/// The same for a vehicle: "auto" is boom if the vehicle has one, else free; a boom that it has not is refused.
/// @param who  asks, for the message @throws common::Error
Mount mountFor(const common::Vehicle& vehicle, const std::string& text, const std::string& who);
std::string mountName(Mount mount);
/// "on", "off" or "auto" (none). @throws common::Error for another word
std::optional<bool> wingsFromName(const std::string& text);
std::string wingsName(const std::optional<bool>& wings);

struct Trial {
  Mount mount = Mount::FREE;
  double gravity = 0;        ///< [m/s2] pull against the thrust axis: 9.81 = upright, 0 = level axis, -9.81 = inverted
  double initial_speed = 0;  ///< [m/s] of ring and centre along the thrust axis (not for HELD)
  double push = 0;           ///< [N] steady force from outside on the ring side, along the thrust axis (not for HELD)
  /// [0, 1] steady thrust / full thrust before the pulse; unset = motors idle. Held until the pulse reaches the motors.
  std::optional<double> initial_thrust_fraction;
  /// [0, 1] thrust that the command returns to after the pulse; unset = motors idle (throttle low).
  std::optional<double> final_thrust_fraction;
  /// Wings on or taken off; unset = on if the vehicle has them, but off on a boom, as in the paper's tests: there the
  /// centripetal force turns them, which is not modelled.
  std::optional<bool> wings;
  /// [s] longest time watched after the pulse has ended at the motors: wings, lightly damped, swing in F for 2 to 3 s
  double horizon = 4.0;

  /// @throws common::Error naming the member
  void validate() const;
};

/// Answer of the lumped model; the members follow msg/SnapPrediction.msg. docs/reduced_model.md defines the margin.
struct SnapPrediction {
  std::string rung = "lumped";
  common::Mode start_mode = common::Mode::UNKNOWN;
  common::Mode end_mode = common::Mode::UNKNOWN;                  ///< UNKNOWN = not settled within the horizon
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
