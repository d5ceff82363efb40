#pragma once
/// SBUS: 25 bytes, 0x0F, 16 x 11 bits (lowest first), flags, 0x00; 100000 baud 8E2, inverted line, every 14 ms (7
/// fast). There is no checksum: only head, tail and the reserved flag bits can be checked, so a flipped bit is
/// accepted.

#include <array>
#include <cstdint>

#include "snapwing/link/channels.h"

namespace snapwing::link {

constexpr std::size_t SBUS_FRAME_SIZE = 25;
constexpr std::uint8_t SBUS_FRAME_LOST = 0x04;
constexpr std::uint8_t SBUS_FAILSAFE = 0x08;
constexpr double SBUS_BURST = 3.5e-3;  ///< [s] all bytes of a frame arrive within this

using Ticks = std::array<std::uint16_t, MAX_CHANNELS>;  ///< 11-bit values

/// us = 5/8 * tick + 880, rounded to the nearest tick, clamped to 0..2047.
std::uint16_t sbusTick(int microseconds);
/// Whole microseconds, rounded down (172 -> 987.5 is shown as 988 by the firmware, so rounded half up).
int sbusMicroseconds(int tick);

/// 16 x 11 bits -> 22 bytes, shared with CRSF.
void packTicks(const Ticks& ticks, std::uint8_t* out);
void unpackTicks(const std::uint8_t* bytes, Ticks& ticks);

/// Channels beyond count are sent as 992 (centre).
WireFrame encodeSbus(const Channels& channels, std::uint8_t flags = 0);

struct SbusFrame {
  Ticks ticks{};
  std::uint8_t flags = 0;
  bool usable() const { return (flags & (SBUS_FRAME_LOST | SBUS_FAILSAFE)) == 0; }
};

/// Collects bytes into frames by their arrival time: a gap of more than the burst's length begins a new frame, and what
/// follows a whole frame within the same burst is ignored, as the firmware does.
class SbusParser {
 public:
  /// @param now  [s] arrival of the byte, any clock that never goes back
  bool push(std::uint8_t byte, double now);
  const SbusFrame& frame() const { return frame_; }
  std::uint64_t badFrames() const { return bad_frames_; }

 private:
  std::array<std::uint8_t, SBUS_FRAME_SIZE> buffer_{};
  std::size_t size_ = 0;
  double burst_start_ = -1e9;
  SbusFrame frame_;
  std::uint64_t bad_frames_ = 0;
};

}  // namespace snapwing::link
