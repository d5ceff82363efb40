#pragma once
/// Payloads of the MSP messages that the bridge and the stand-in flight controller exchange, as plain data. Decoders
/// return false and leave their result alone if the payload is too short; longer ones (newer firmware) are accepted.

#include <array>
#include <cstdint>

#include "snapwing/link/channels.h"
#include "snapwing/link/msp.h"

namespace snapwing::link {

constexpr std::uint8_t BOX_ARM = 0;        ///< permanent id
constexpr std::uint8_t BOX_FAILSAFE = 27;  ///< permanent id
constexpr std::uint8_t BOX_MSP_OVERRIDE = 50;
constexpr int MSP_MAX_CHANNELS = 16;  ///< that we send; the firmware takes 18

struct ApiVersion {
  int protocol = 0, major = 0, minor = 0;
};
struct FailsafeConfig {
  double delay = 0;         ///< [s] stage 1
  double landing_time = 0;  ///< [s]
  int throttle = 0;         ///< [us]
  int switch_mode = 0;
  double low_throttle_delay = 0;  ///< [s]
  int procedure = 0;              ///< 0 = landing, 1 = motors off, 2 = GPS rescue
};
struct StatusReply {
  int cycle_time = 0;       ///< [us]
  std::uint64_t modes = 0;  ///< bit n = n-th entry of BOXIDS; the first 64
  std::uint32_t arming_flags = 0;
  int arming_flag_count = 0;  ///< 0: the controller does not tell its flags (a short answer)
};
struct BoxIds {
  std::array<std::uint8_t, 64> ids{};
  int count = 0;
  /// Place of a permanent id, or -1.
  int find(std::uint8_t id) const;
};
struct RxMap {
  std::array<std::uint8_t, 8> map{};
  int count = 0;  ///< 8, or 4 where only the flight channels are reported
};
/// AETR1234: roll, pitch, yaw, throttle are read from wire places 0, 1, 3, 2.
constexpr std::array<std::uint8_t, 8> DEFAULT_RX_MAP = {0, 1, 3, 2, 4, 5, 6, 7};

MspPacket request(MspVersion version, std::uint16_t id);
MspPacket setRawRc(MspVersion version, const Channels& channels);

bool decode(const MspPacket& packet, ApiVersion& out);
bool decode(const MspPacket& packet, FailsafeConfig& out);
bool decode(const MspPacket& packet, StatusReply& out);
bool decode(const MspPacket& packet, BoxIds& out);
bool decode(const MspPacket& packet, RxMap& out);
/// MSP_RC, MSP_MOTOR and SET_RAW_RC: as many u16 as there are, at most 16.
bool decode(const MspPacket& packet, Channels& out);

/// Fill in the payload of an answer.
void encode(const ApiVersion& in, MspPacket& packet);
void encode(const FailsafeConfig& in, MspPacket& packet);
void encode(const StatusReply& in, MspPacket& packet);
void encode(const BoxIds& in, MspPacket& packet);
void encode(const RxMap& in, MspPacket& packet);
void encode(const Channels& in, MspPacket& packet);

}  // namespace snapwing::link
