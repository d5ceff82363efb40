#include "snapwing/link/sbus.h"

#include <algorithm>

namespace snapwing::link {
namespace {

constexpr std::uint16_t CENTRE_TICK = 992;
constexpr std::uint8_t HEAD = 0x0F;

}  // namespace

std::uint16_t sbusTick(int microseconds) {
  const int numerator = 8 * (microseconds - 880);  // tick = numerator / 5, rounded to the nearest
  return static_cast<std::uint16_t>(std::clamp((numerator + (numerator >= 0 ? 2 : -2)) / 5, 0, 2047));
}

int sbusMicroseconds(int tick) { return 880 + (5 * tick + 4) / 8; }

void packTicks(const Ticks& ticks, std::uint8_t* out) {
  std::fill(out, out + 22, std::uint8_t{0});
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const std::uint32_t value = static_cast<std::uint32_t>(ticks[i] & 0x7FFU) << (11 * i % 8);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto part = static_cast<std::uint8_t>(value >> (8 * k));
      if (part != 0) out[11 * i / 8 + k] = static_cast<std::uint8_t>(out[11 * i / 8 + k] | part);
    }
  }
}

void unpackTicks(const std::uint8_t* bytes, Ticks& ticks) {
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    std::uint32_t value = 0;
    for (std::size_t k = 0; k < 3 && 11 * i / 8 + k < 22; ++k) {
      value |= static_cast<std::uint32_t>(bytes[11 * i / 8 + k]) << (8 * k);
    }
    ticks[i] = static_cast<std::uint16_t>((value >> (11 * i % 8)) & 0x7FFU);
  }
}

WireFrame encodeSbus(const Channels& channels, std::uint8_t flags) {
  Ticks ticks;
  ticks.fill(CENTRE_TICK);
  const int count = std::clamp(channels.count, 0, MAX_CHANNELS);
  for (int i = 0; i < count; ++i)
    ticks[static_cast<std::size_t>(i)] = sbusTick(channels.us[static_cast<std::size_t>(i)]);
  WireFrame frame;
  frame.size = SBUS_FRAME_SIZE;
  frame.bytes[0] = HEAD;
  packTicks(ticks, &frame.bytes[1]);
  frame.bytes[23] = flags;
  frame.bytes[24] = 0x00;
  return frame;
}

bool SbusParser::push(std::uint8_t byte, double now) {
  if (!(now - burst_start_ <= SBUS_BURST)) {  // also true for NaN: begin anew rather than trust a broken clock
    if (size_ > 0 && size_ < SBUS_FRAME_SIZE) ++bad_frames_;
    size_ = 0;
    burst_start_ = now;
  }
  if (size_ >= SBUS_FRAME_SIZE) return false;  // a second frame in the same burst
  if (size_ == 0 && byte != HEAD) return false;
  buffer_[size_++] = byte;
  if (size_ < SBUS_FRAME_SIZE) return false;
  if (buffer_[24] != 0x00) {
    ++bad_frames_;
    return false;
  }
  unpackTicks(&buffer_[1], frame_.ticks);
  frame_.flags = buffer_[23];
  return true;
}

}  // namespace snapwing::link
