#pragma once
/// Conditions of the vehicle during a pulse: mount, gravity, initial state, external force.

#include <optional>
#include <string>

namespace snapwing::vehicle {

struct Vehicle;

enum class Mount {
  FREE,  ///< flies freely along its thrust axis
  BOOM,  ///< at the end of a boom, thrust tangential: the boom's inertia, drag and friction join the ring side
  HELD,  ///< the ring stands still; only the centre moves
};

/// "free", "boom" or "held". @throws common::Error for another word
Mount mountFromName(const std::string& text);
/// Likewise for a vehicle: "auto" is boom if the vehicle has one, else free.
/// @param who  asks, for the message @throws common::Error for another word, or "boom" without a boom
Mount mountFor(const Vehicle& vehicle, const std::string& text, const std::string& who);
std::string mountName(Mount mount);
/// "on", "off" or "auto" (unset). @throws common::Error for another word
std::optional<bool> wingsFromName(const std::string& text);
std::string wingsName(const std::optional<bool>& wings);

struct Trial {
  Mount mount = Mount::FREE;
  double gravity = 0;        ///< [m/s2] against the thrust axis: 9.81 = upright, 0 = level axis, -9.81 = inverted
  double initial_speed = 0;  ///< [m/s] of ring and centre along the thrust axis (not for HELD)
  double push = 0;           ///< [N] steady external force on the ring side, along the thrust axis (not for HELD)
  /// [0, 1] steady thrust / full thrust before the pulse; unset = motors idle. Held until the pulse reaches the motors.
  std::optional<double> initial_thrust_fraction;
  /// [0, 1] demanded thrust after the pulse; unset = motors idle (throttle low).
  std::optional<double> final_thrust_fraction;
  /// Wings on or removed; unset = on if the vehicle has them, but off on a boom, as in the paper's tests: there the
  /// centripetal force rotates them, which models along the axis neglect.
  std::optional<bool> wings;
  /// [s] longest time simulated after the pulse has ended at the motors: lightly damped wings swing in F for 2 to 3 s
  double horizon = 4.0;

  /// @throws common::Error naming the member
  void validate() const;
};

}  // namespace snapwing::vehicle
