#pragma once
/// Remote-control channels on the wire. Order A, E, T, R, AUX1, ... (Betaflight's default map), microseconds.

#include <array>
#include <cstdint>

#include "snapwing/common/throttle_scale.h"

namespace snapwing::link {

constexpr int MAX_CHANNELS = 16;
constexpr int FRAME_CHANNELS = 8;  ///< what the bridge sends: never fewer than 5, else an armed aircraft stays armed

enum ChannelIndex { ROLL = 0, PITCH = 1, THROTTLE = 2, YAW = 3, AUX1 = 4 };

constexpr int CHANNEL_LOW = 1000;        ///< [us]
constexpr int CHANNEL_CENTRE = 1500;     ///< [us]
constexpr int CHANNEL_HIGH = 2000;       ///< [us]
constexpr int CHANNEL_MIN_VALID = 885;   ///< [us] outside these the flight controller calls a channel invalid
constexpr int CHANNEL_MAX_VALID = 2115;  ///< [us]

struct Channels {
  std::array<std::uint16_t, MAX_CHANNELS> us{};
  int count = 0;
};

/// Throttle low, AUX1 low, sticks centred: what is sent whenever nothing else is allowed. FRAME_CHANNELS long.
Channels safeChannels();

/// Stick travel -> whole microseconds by common's rule, clamped to the scale. Not finite gives CHANNEL_LOW.
/// @param travel  [0, 1]
std::uint16_t travelToMicroseconds(double travel, const common::ThrottleScale& scale);
/// @param stick  [-1, 1], 0 = centre. Not finite gives the centre.
std::uint16_t stickToMicroseconds(double stick);

/// Bytes ready for a line; fixed capacity, so that sending allocates nothing.
struct WireFrame {
  std::array<std::uint8_t, 64> bytes{};
  std::size_t size = 0;
};

}  // namespace snapwing::link
