#include "snapwing/link/motor_stream.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace snapwing::link {

namespace {

void putFloat(double number, std::uint8_t* at) {
  const float value = static_cast<float>(number);
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  for (std::size_t k = 0; k < 4; ++k) at[k] = static_cast<std::uint8_t>(bits >> (8 * k));
}

float floatAt(const std::uint8_t* at) {
  std::uint32_t bits = 0;
  for (std::size_t k = 0; k < 4; ++k) bits |= static_cast<std::uint32_t>(at[k]) << (8 * k);
  float value = 0;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

}  // namespace

MotorPacket encodeMotors(const MotorOutputs& outputs) {
  MotorPacket packet{};
  for (std::size_t i = 0; i < outputs.size(); ++i)
    putFloat(std::isfinite(outputs[i]) ? std::clamp(outputs[i], 0.0, 1.0) : 0.0, packet.data() + 4 * i);
  return packet;
}

bool decodeMotors(const std::uint8_t* bytes, std::size_t size, MotorOutputs& outputs) {
  if (bytes == nullptr || size != MOTOR_PACKET_SIZE) return false;
  MotorOutputs read{};
  for (std::size_t i = 0; i < read.size(); ++i) {
    const float value = floatAt(bytes + 4 * i);
    if (!(value >= 0.0F && value <= 1.0F)) return false;
    read[i] = static_cast<double>(value);
  }
  outputs = read;
  return true;
}

ImuPacket encodeImu(const std::array<double, 3>& specific_force) {
  ImuPacket packet{};
  for (std::size_t i = 0; i < 3; ++i) putFloat(specific_force[i], packet.data() + 4 * i);
  return packet;
}

bool decodeImu(const std::uint8_t* bytes, std::size_t size, std::array<double, 3>& specific_force) {
  if (bytes == nullptr || size != IMU_PACKET_SIZE) return false;
  std::array<double, 3> read{};
  for (std::size_t i = 0; i < 3; ++i) {
    read[i] = static_cast<double>(floatAt(bytes + 4 * i));
    if (!std::isfinite(read[i])) return false;
  }
  specific_force = read;
  return true;
}

}  // namespace snapwing::link
