#include "snapwing/link/crsf.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "crc.h"

namespace snapwing::link {
namespace {

constexpr std::uint8_t ADDRESS = 0xC8;
constexpr std::uint8_t TYPE_CHANNELS = 0x16;
constexpr std::uint8_t CHANNELS_LENGTH = 24;  // type, 22 bytes, checksum
constexpr std::uint16_t CENTRE_TICK = 992;

}  // namespace

std::uint16_t crsfTick(int microseconds) {
  return static_cast<std::uint16_t>(std::clamp<long>(std::lround((microseconds - 881) / 0.62477), 0, 2047));
}

int crsfMicroseconds(int tick) { return static_cast<int>(std::lround(0.62477 * tick + 881.0)); }

WireFrame encodeCrsf(const Channels& channels) {
  Ticks ticks;
  ticks.fill(CENTRE_TICK);
  const int count = std::clamp(channels.count, 0, MAX_CHANNELS);
  for (int i = 0; i < count; ++i)
    ticks[static_cast<std::size_t>(i)] = crsfTick(channels.us[static_cast<std::size_t>(i)]);
  WireFrame frame;
  frame.size = CRSF_FRAME_SIZE;
  frame.bytes[0] = ADDRESS;
  frame.bytes[1] = CHANNELS_LENGTH;
  frame.bytes[2] = TYPE_CHANNELS;
  packTicks(ticks, &frame.bytes[3]);
  frame.bytes[25] = crc8DvbS2(&frame.bytes[2], 23);
  return frame;
}

bool CrsfParser::push(std::uint8_t byte) {
  if (size_ == 0 && byte != ADDRESS) return false;
  if (size_ == 1 && (byte < 2 || byte > 62)) {  // no such length: look for a head again
    ++bad_frames_;
    size_ = 0;
    return false;
  }
  buffer_[size_++] = byte;
  if (size_ < 2 || size_ < static_cast<std::size_t>(buffer_[1]) + 2) return false;
  return complete();
}

bool CrsfParser::complete() {
  const std::size_t length = buffer_[1];
  size_ = 0;
  if (crc8DvbS2(&buffer_[2], length - 1) != buffer_[length + 1]) {
    ++bad_frames_;
    return false;
  }
  if (buffer_[2] != TYPE_CHANNELS || length != CHANNELS_LENGTH) return false;
  unpackTicks(&buffer_[3], ticks_);
  return true;
}

}  // namespace snapwing::link
