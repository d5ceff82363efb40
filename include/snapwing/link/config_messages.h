#pragma once
/// Payloads of the MSP messages that tell how a flight controller is set. Decoders return false and leave their result
/// alone if the payload is too short; longer ones (newer firmware) are accepted.

#include <array>
#include <cstdint>

#include "snapwing/link/msp_messages.h"

namespace snapwing::link {

/// What the controller puts in the place of a channel whose signal is lost.
enum class RxFailMode : std::uint8_t { AUTO = 0, HOLD = 1, SET = 2 };
struct RxFailChannel {
  RxFailMode mode = RxFailMode::AUTO;
  int value = 1500;  ///< [us] for SET
};
/// Channels in the controller's order: roll, pitch, yaw, throttle, AUX1 ...
struct RxFailConfig {
  std::array<RxFailChannel, 18> channels{};
  int count = 0;
};
/// The firmware's defaults: flight channels AUTO, AUX held.
RxFailConfig defaultRxFail();

/// A mode is in force while an AUX channel is within a range.
struct ModeRange {
  std::uint8_t box = 0;  ///< permanent id
  int aux = 0;           ///< 0 = AUX1
  int from = 0, to = 0;  ///< [us] multiples of 25 from 900; no range if not from < to
  bool used() const { return from < to; }
};
struct ModeRanges {
  std::array<ModeRange, 20> ranges{};
  int count = 0;
};
/// ARM on AUX1, 1700 to 2100 us.
ModeRanges defaultModeRanges();

constexpr std::uint32_t FEATURE_RX_PPM = 1U << 0;
constexpr std::uint32_t FEATURE_RX_SERIAL = 1U << 3;
constexpr std::uint32_t FEATURE_3D = 1U << 12;
constexpr std::uint32_t FEATURE_RX_PARALLEL_PWM = 1U << 13;
constexpr std::uint32_t FEATURE_RX_MSP = 1U << 14;
constexpr std::uint32_t FEATURE_AIRMODE = 1U << 22;
constexpr std::uint32_t FEATURE_RX_SPI = 1U << 25;
struct FeatureConfig {
  std::uint32_t bits = 0;
};

/// The part of MSP_RX_CONFIG that concerns throttle. [us]
struct RxConfig {
  int min_check = 1050;  ///< throttle below counts as low
  int max_check = 1900;
  int shortest = 885, longest = 2115;  ///< valid pulses
};

enum class ThrottleLimitType : std::uint8_t { OFF = 0, SCALE = 1, CLIP = 2 };
/// Of the rate profile in force (MSP_RC_TUNING).
struct ThrottleLimit {
  ThrottleLimitType type = ThrottleLimitType::OFF;
  int percent = 100;
};

/// Of the PID profile in force (MSP_PID_ADVANCED).
struct MotorOutputLimit {
  int percent = 100;
};

bool decode(const MspPacket& packet, RxFailConfig& out);
bool decode(const MspPacket& packet, ModeRanges& out);
bool decode(const MspPacket& packet, FeatureConfig& out);
bool decode(const MspPacket& packet, RxConfig& out);
bool decode(const MspPacket& packet, ThrottleLimit& out);
bool decode(const MspPacket& packet, MotorOutputLimit& out);

/// Fill in the payload of an answer; what is not known here is 0.
void encode(const RxFailConfig& in, MspPacket& packet);
void encode(const ModeRanges& in, MspPacket& packet);
void encode(const FeatureConfig& in, MspPacket& packet);
void encode(const RxConfig& in, MspPacket& packet);
void encode(const ThrottleLimit& in, MspPacket& packet);
void encode(const MotorOutputLimit& in, MspPacket& packet);

}  // namespace snapwing::link
