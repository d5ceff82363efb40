#include "snapwing/link/imu_question.h"

#include <cmath>

#include "snapwing/common/error.h"

namespace snapwing::link {
namespace {

constexpr std::size_t LEAST_SIZE = 12, FULL_SIZE = 18;  ///< [bytes] without and with the magnetometer

int number(const MspPacket& packet, std::size_t at) {
  if (at + 2 > packet.size) return 0;
  const unsigned bits = packet.payload[at] | static_cast<unsigned>(packet.payload[at + 1]) << 8;
  return static_cast<std::int16_t>(bits);
}

}  // namespace

void ImuSettings::validate() const {
  if (std::isfinite(counts_per_g) && counts_per_g >= 32 && counts_per_g <= 16384) return;
  throw common::SettingError("radio bridge", "imu-counts-per-g", std::to_string(counts_per_g), "32 .. 16384");
}

bool decode(const MspPacket& packet, RawImu& out) {
  if (packet.size < LEAST_SIZE) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    out.acceleration[i] = number(packet, 2 * i);
    out.rotation[i] = number(packet, 6 + 2 * i);
    out.field[i] = number(packet, 12 + 2 * i);
  }
  return true;
}

void encode(const RawImu& in, MspPacket& packet) {
  packet.size = FULL_SIZE;
  const auto put = [&packet](std::size_t at, int value) {
    const auto bits = static_cast<std::uint16_t>(static_cast<std::int16_t>(value));
    packet.payload[at] = static_cast<std::uint8_t>(bits & 0xFFU);
    packet.payload[at + 1] = static_cast<std::uint8_t>(bits >> 8);
  };
  for (std::size_t i = 0; i < 3; ++i) {
    put(2 * i, in.acceleration[i]);
    put(6 + 2 * i, in.rotation[i]);
    put(12 + 2 * i, in.field[i]);
  }
}

bool ImuQuestion::take(const MspPacket& packet, double now) {
  RawImu raw;
  if (packet.direction != '>' || !decode(packet, raw)) {
    refused_ = true;
    return false;
  }
  ++reading_.number;
  reading_.time = now;
  for (std::size_t i = 0; i < 3; ++i)
    reading_.acceleration[i] = raw.acceleration[i] / settings_.counts_per_g * STANDARD_GRAVITY;
  return true;
}

}  // namespace snapwing::link
