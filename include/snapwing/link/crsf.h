#pragma once
/// CRSF channels frame: 26 bytes, 0xC8, 24, 0x16, 22 bytes packed as in SBUS, crc8 (0xD5) over type and payload;
/// 420000 baud 8N1.

#include <array>
#include <cstdint>

#include "snapwing/link/channels.h"
#include "snapwing/link/sbus.h"

namespace snapwing::link {

constexpr std::size_t CRSF_FRAME_SIZE = 26;

/// us = 0.62477 * tick + 881, to the nearest tick, clamped to 0..2047.
std::uint16_t crsfTick(int microseconds);
int crsfMicroseconds(int tick);

WireFrame encodeCrsf(const Channels& channels);

/// Finds channel frames in a stream. Frames of other types are skipped if their checksum is good; bad ones are counted.
class CrsfParser {
 public:
  /// @return true when a good channels frame is complete
  bool push(std::uint8_t byte);
  const Ticks& ticks() const { return ticks_; }
  std::uint64_t badFrames() const { return bad_frames_; }

 private:
  bool complete();
  std::array<std::uint8_t, 64> buffer_{};
  std::size_t size_ = 0;
  Ticks ticks_{};
  std::uint64_t bad_frames_ = 0;
};

}  // namespace snapwing::link
