#include "snapwing/link/config_messages.h"

#include <algorithm>

namespace snapwing::link {
namespace {

constexpr int STEP_ORIGIN = 900, STEP = 25;  ///< [us] in which ranges of modes are counted
// Places of bytes that matter in long payloads, and sizes of these in release 4.5.
constexpr std::size_t RX_CONFIG_SIZE = 24, RX_MAX_CHECK = 1, RX_MIN_CHECK = 5, RX_SHORTEST = 8, RX_LONGEST = 10;
constexpr std::size_t RC_TUNING_SIZE = 23, LIMIT_TYPE = 14, LIMIT_PERCENT = 15;
constexpr std::size_t PID_ADVANCED_SIZE = 61, OUTPUT_LIMIT = 47;

int word(const MspPacket& packet, std::size_t at) { return packet.payload[at] | packet.payload[at + 1] << 8; }

void putWord(MspPacket& packet, std::size_t at, int value) {
  packet.payload[at] = static_cast<std::uint8_t>(value);
  packet.payload[at + 1] = static_cast<std::uint8_t>(value >> 8);
}

void blank(MspPacket& packet, std::size_t size) {
  packet.size = size;
  std::fill_n(packet.payload.begin(), size, std::uint8_t{0});
}

std::uint8_t steps(int microseconds) { return static_cast<std::uint8_t>((microseconds - STEP_ORIGIN) / STEP); }

}  // namespace

RxFailConfig defaultRxFail() {
  RxFailConfig config;
  config.count = static_cast<int>(config.channels.size());
  config.channels[3].value = 885;
  for (std::size_t i = 4; i < config.channels.size(); ++i) config.channels[i].mode = RxFailMode::HOLD;
  return config;
}

ModeRanges defaultModeRanges() {
  ModeRanges ranges;
  ranges.count = static_cast<int>(ranges.ranges.size());
  ranges.ranges[0] = {BOX_ARM, 0, 1700, 2100};
  return ranges;
}

bool decode(const MspPacket& packet, RxFailConfig& out) {
  if (packet.size < 3 * 5) return false;
  out.count = static_cast<int>(std::min(packet.size / 3, out.channels.size()));
  for (std::size_t i = 0; i < static_cast<std::size_t>(out.count); ++i) {
    out.channels[i] = {static_cast<RxFailMode>(packet.payload[3 * i]), word(packet, 3 * i + 1)};
  }
  return true;
}

bool decode(const MspPacket& packet, ModeRanges& out) {
  if (packet.size < 4) return false;
  out.count = static_cast<int>(std::min(packet.size / 4, out.ranges.size()));
  for (std::size_t i = 0; i < static_cast<std::size_t>(out.count); ++i) {
    const std::uint8_t* at = packet.payload.data() + 4 * i;
    out.ranges[i] = {at[0], at[1], STEP_ORIGIN + STEP * at[2], STEP_ORIGIN + STEP * at[3]};
  }
  return true;
}

bool decode(const MspPacket& packet, FeatureConfig& out) {
  if (packet.size < 4) return false;
  out.bits = static_cast<std::uint32_t>(word(packet, 0)) | static_cast<std::uint32_t>(word(packet, 2)) << 16;
  return true;
}

bool decode(const MspPacket& packet, RxConfig& out) {
  if (packet.size < RX_LONGEST + 2) return false;
  out = {word(packet, RX_MIN_CHECK), word(packet, RX_MAX_CHECK), word(packet, RX_SHORTEST), word(packet, RX_LONGEST)};
  return true;
}

bool decode(const MspPacket& packet, ThrottleLimit& out) {
  if (packet.size <= LIMIT_PERCENT) return false;
  out = {static_cast<ThrottleLimitType>(packet.payload[LIMIT_TYPE]), packet.payload[LIMIT_PERCENT]};
  return true;
}

bool decode(const MspPacket& packet, MotorOutputLimit& out) {
  if (packet.size <= OUTPUT_LIMIT) return false;
  out.percent = packet.payload[OUTPUT_LIMIT];
  return true;
}

void encode(const RxFailConfig& in, MspPacket& packet) {
  blank(packet, 3 * static_cast<std::size_t>(std::clamp(in.count, 0, 18)));
  for (std::size_t i = 0; 3 * i < packet.size; ++i) {
    packet.payload[3 * i] = static_cast<std::uint8_t>(in.channels[i].mode);
    putWord(packet, 3 * i + 1, in.channels[i].value);
  }
}

void encode(const ModeRanges& in, MspPacket& packet) {
  blank(packet, 4 * static_cast<std::size_t>(std::clamp(in.count, 0, 20)));
  for (std::size_t i = 0; 4 * i < packet.size; ++i) {
    if (!in.ranges[i].used()) continue;  // unused ones are all 0
    std::uint8_t* at = packet.payload.data() + 4 * i;
    at[0] = in.ranges[i].box;
    at[1] = static_cast<std::uint8_t>(in.ranges[i].aux);
    at[2] = steps(in.ranges[i].from);
    at[3] = steps(in.ranges[i].to);
  }
}

void encode(const FeatureConfig& in, MspPacket& packet) {
  blank(packet, 4);
  putWord(packet, 0, static_cast<int>(in.bits & 0xFFFF));
  putWord(packet, 2, static_cast<int>(in.bits >> 16));
}

void encode(const RxConfig& in, MspPacket& packet) {
  blank(packet, RX_CONFIG_SIZE);
  putWord(packet, RX_MIN_CHECK, in.min_check);
  putWord(packet, RX_MAX_CHECK, in.max_check);
  putWord(packet, RX_SHORTEST, in.shortest);
  putWord(packet, RX_LONGEST, in.longest);
}

void encode(const ThrottleLimit& in, MspPacket& packet) {
  blank(packet, RC_TUNING_SIZE);
  packet.payload[LIMIT_TYPE] = static_cast<std::uint8_t>(in.type);
  packet.payload[LIMIT_PERCENT] = static_cast<std::uint8_t>(in.percent);
}

void encode(const MotorOutputLimit& in, MspPacket& packet) {
  blank(packet, PID_ADVANCED_SIZE);
  packet.payload[OUTPUT_LIMIT] = static_cast<std::uint8_t>(in.percent);
}

}  // namespace snapwing::link
