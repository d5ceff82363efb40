#pragma once
/// Motor outputs of the stand-in flight controller as UDP datagrams, laid out as Betaflight's simulator target sends
/// them: four little-endian floats, motor = (us - 1000) / 1000, 0 when disarmed.

#include <array>
#include <cstddef>
#include <cstdint>

namespace snapwing::link {

constexpr int MOTOR_COUNT = 4;
constexpr std::uint16_t MOTOR_STREAM_PORT = 9002;           ///< default UDP port of the receiver, on the loopback
constexpr std::size_t MOTOR_PACKET_SIZE = 4 * MOTOR_COUNT;  ///< [bytes]
using MotorPacket = std::array<std::uint8_t, MOTOR_PACKET_SIZE>;
using MotorOutputs = std::array<double, MOTOR_COUNT>;  ///< [1] 0 = off, (1070 - 1000) / 1000 = idle, 1 = full

/// @param outputs  clamped to [0, 1]; not finite becomes 0
MotorPacket encodeMotors(const MotorOutputs& outputs);

/// @param outputs  written only if the datagram is good
/// @return false if the size is wrong or a value is not finite or outside [0, 1]
bool decodeMotors(const std::uint8_t* bytes, std::size_t size, MotorOutputs& outputs);

/// The other way: what the simulated vehicle's accelerometer measures, three little-endian floats [m/s2].
constexpr std::size_t IMU_PACKET_SIZE = 12;  ///< [bytes]
using ImuPacket = std::array<std::uint8_t, IMU_PACKET_SIZE>;
ImuPacket encodeImu(const std::array<double, 3>& specific_force);
/// @return false, and `specific_force` as it was, if the size is wrong or a value is not finite
bool decodeImu(const std::uint8_t* bytes, std::size_t size, std::array<double, 3>& specific_force);

}  // namespace snapwing::link
