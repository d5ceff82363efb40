#include "snapwing/link/motor_stream.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace snapwing::link {

MotorPacket encodeMotors(const MotorOutputs& outputs) {
  MotorPacket packet{};
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const float value = std::isfinite(outputs[i]) ? static_cast<float>(std::clamp(outputs[i], 0.0, 1.0)) : 0.0F;
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    for (std::size_t k = 0; k < 4; ++k) packet[4 * i + k] = static_cast<std::uint8_t>(bits >> (8 * k));
  }
  return packet;
}

bool decodeMotors(const std::uint8_t* bytes, std::size_t size, MotorOutputs& outputs) {
  if (bytes == nullptr || size != MOTOR_PACKET_SIZE) return false;
  MotorOutputs read{};
  for (std::size_t i = 0; i < read.size(); ++i) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 4; ++k) bits |= static_cast<std::uint32_t>(bytes[4 * i + k]) << (8 * k);
    float value = 0;
    std::memcpy(&value, &bits, sizeof value);
    if (!(value >= 0.0F && value <= 1.0F)) return false;
    read[i] = static_cast<double>(value);
  }
  outputs = read;
  return true;
}

}  // namespace snapwing::link
