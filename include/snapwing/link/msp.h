#pragma once
/// MultiWii serial protocol, versions 1 and 2, both directions.
/// v1: `$ M dir size(u8) id(u8) payload xor(size..payload)`; v2: `$ X dir flags(u8) id(u16) size(u16) payload crc8`.
/// Direction '<' asks, '>' answers, '!' refuses. Little endian.

#include <array>
#include <cstddef>
#include <cstdint>

namespace snapwing::link {

enum class MspVersion : std::uint8_t { V1 = 1, V2 = 2 };

enum MspId : std::uint16_t {
  MSP_API_VERSION = 1,
  MSP_FC_VARIANT = 2,
  MSP_FC_VERSION = 3,
  MSP_MODE_RANGES = 34,
  MSP_FEATURE_CONFIG = 36,
  MSP_RX_CONFIG = 44,
  MSP_RX_MAP = 64,
  MSP_FAILSAFE_CONFIG = 75,
  MSP_RXFAIL_CONFIG = 77,
  MSP_PID_ADVANCED = 94,
  MSP_STATUS = 101,
  MSP_RAW_IMU = 102,
  MSP_MOTOR = 104,
  MSP_RC = 105,
  MSP_RC_TUNING = 111,
  MSP_BOXIDS = 119,
  MSP_SET_RAW_RC = 200,
};

constexpr std::size_t MSP_MAX_PAYLOAD = 255;
constexpr std::size_t MSP_MAX_FRAME = MSP_MAX_PAYLOAD + 9;

struct MspPacket {
  MspVersion version = MspVersion::V1;
  char direction = '<';
  std::uint8_t flags = 0;  ///< v2 only
  std::uint16_t id = 0;
  std::size_t size = 0;  ///< of the payload
  std::array<std::uint8_t, MSP_MAX_PAYLOAD> payload{};
};

/// Writes one frame.
/// @param capacity  of `out`; MSP_MAX_FRAME always suffices
/// @return bytes written; 0 if it does not fit, or a v1 id is above 255, or a v1 size above 254 (255 marks an
///         extension that we do not speak)
std::size_t encodeMsp(const MspPacket& packet, std::uint8_t* out, std::size_t capacity);

/// Reads a stream byte by byte and never allocates. A frame with a bad checksum, an unknown direction or too large a
/// payload is dropped and counted; reading goes on at the next '$'.
class MspParser {
 public:
  /// @return true when `byte` completed a good frame, which packet() then holds until the next call
  bool push(std::uint8_t byte);
  const MspPacket& packet() const { return packet_; }
  std::uint64_t badFrames() const { return bad_frames_; }
  /// Forgets a frame begun: after a reconnect its rest will not come.
  void reset() { state_ = State::START; }

 private:
  enum class State {
    START,
    VERSION,
    DIRECTION,
    V1_SIZE,
    V1_ID,
    V2_FLAGS,
    V2_ID_LOW,
    V2_ID_HIGH,
    V2_SIZE_LOW,
    V2_SIZE_HIGH,
    PAYLOAD,
    CHECK
  };
  bool header(std::uint8_t byte);
  bool reject();
  void afterHeader();
  void check(std::uint8_t byte);

  State state_ = State::START;
  MspPacket packet_;
  std::size_t received_ = 0;
  std::uint8_t check_ = 0;
  std::uint64_t bad_frames_ = 0;
};

}  // namespace snapwing::link
