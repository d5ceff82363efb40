#pragma once
/// The vehicle's flight modes, defined once. ROS message constants are checked against this enum by static_assert.

#include <cstdint>
#include <string>

namespace snapwing::vehicle {

enum class Mode : std::uint8_t {
  UNKNOWN = 0,     ///< not settled, or not known
  FIXED_WING = 1,  ///< F: first equilibrium, u = 0, wings unfolded
  QUADROTOR = 2,   ///< Q: second equilibrium, wings folded
};

/// "F", "Q" or "unknown".
std::string modeName(Mode mode);

/// @param text "F", "fixed_wing", "Q" or "quadrotor" (any case). @throws Error otherwise.
Mode modeFromName(const std::string& text);

/// The target mode of a switch from `mode`. @throws Error for UNKNOWN.
Mode otherMode(Mode mode);

}  // namespace snapwing::vehicle
