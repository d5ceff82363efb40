#pragma once
/// Key and authentication of the link's messages: HMAC-SHA-512-256 (libsodium's crypto_auth) over a domain label, the
/// vehicle's id, the channel's name and the LCM bytes. Without the key nobody commands thrust; with it, a message moved
/// to another channel or vehicle does not verify.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "snapwing_lcm/sealed_t.hpp"

namespace snapwing::link {

constexpr const char* CHANNEL_PULSE = "SNAPWING_PULSE";
constexpr const char* CHANNEL_ABORT = "SNAPWING_ABORT";
constexpr const char* CHANNEL_HEARTBEAT = "SNAPWING_HEARTBEAT";
constexpr const char* CHANNEL_HELLO = "SNAPWING_HELLO";
constexpr const char* CHANNEL_STATUS = "SNAPWING_LINK_STATUS";
constexpr const char* CHANNEL_TELEMETRY = "SNAPWING_TELEMETRY";
constexpr const char* DEFAULT_LCM_URL = "udpm://239.255.76.67:7667?ttl=0";
constexpr const char* DEFAULT_VEHICLE_ID = "snapwing";

using Key = std::array<std::uint8_t, 32>;

/// Draws a key and writes it as 64 hexadecimal digits, readable by the owner only.
/// @throws common::FileError if the file exists or cannot be written
void createKeyFile(const std::string& path);
/// @throws common::FileError if missing, not 64 hexadecimal digits, or open to group or others
Key loadKeyFile(const std::string& path);

/// Where a vehicle's key lies unless said otherwise: ~/.ros/snapwing_link_ID.key, with '_' for each '/' of the id.
std::string defaultKeyFile(const std::string& vehicle_id);
/// Code over a domain label, then each part with its length.
std::array<std::uint8_t, 32> authenticationCode(const Key& key, std::string_view label,
                                                std::initializer_list<std::string_view> parts);
/// Compares in constant time.
bool sameCode(const std::array<std::uint8_t, 32>& a, const std::array<std::uint8_t, 32>& b);

/// What arrived on a channel of ours.
enum class Envelope {
  GOOD,
  OTHER_VERSION,  ///< of another release of these programs
  OTHER_VEHICLE,  ///< well formed, and meant for another vehicle
  BAD,            ///< malformed, or its code is wrong: another key, or a forgery
};

class Sealer {
 public:
  /// @param vehicle_id  1 to 32 characters: letters, digits, '_', '-', '.', '/'
  /// @throws common::SettingError
  explicit Sealer(const Key& key, const std::string& vehicle_id = DEFAULT_VEHICLE_ID);

  /// @return false if the payload is too large
  bool seal(const std::string& channel, const std::uint8_t* payload, std::size_t size,
            snapwing_lcm::sealed_t& out) const;
  /// @return true if the envelope is of our version and vehicle and its code is right
  bool verify(const std::string& channel, const snapwing_lcm::sealed_t& sealed) const;
  /// @param sealed  filled for GOOD and OTHER_VEHICLE
  Envelope open(const std::string& channel, const void* bytes, std::size_t size, snapwing_lcm::sealed_t& sealed) const;
  /// Version that bytes on a channel of ours claim to have; 0 if they cannot be an envelope of any release.
  static int claimedVersion(const void* bytes, std::size_t size);
  const std::string& vehicleId() const { return vehicle_id_; }

  /// LCM message -> bytes of its envelope, ready to publish. Empty if it does not fit.
  template <class Message>
  std::vector<std::uint8_t> wrap(const std::string& channel, const Message& message) const {
    std::vector<std::uint8_t> payload(static_cast<std::size_t>(message.getEncodedSize()));
    snapwing_lcm::sealed_t sealed{};
    if (message.encode(payload.data(), 0, static_cast<int>(payload.size())) < 0) return {};
    if (!seal(channel, payload.data(), payload.size(), sealed)) return {};
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(sealed.getEncodedSize()));
    if (sealed.encode(bytes.data(), 0, static_cast<int>(bytes.size())) < 0) return {};
    return bytes;
  }

  /// Bytes from the network -> message. False for everything that is not exactly one good envelope with exactly one
  /// message of this type.
  template <class Message>
  bool unwrap(const std::string& channel, const void* bytes, std::size_t size, Message& out) const {
    snapwing_lcm::sealed_t sealed;
    if (open(channel, bytes, size, sealed) != Envelope::GOOD) return false;
    return out.decode(sealed.payload, 0, sealed.payload_size) == sealed.payload_size;
  }

 private:
  std::array<std::uint8_t, 32> code(const std::string& channel, const snapwing_lcm::sealed_t& sealed) const;
  Key key_;
  std::string vehicle_id_;
};

/// The vehicle's name in an envelope, printable characters only. Not authenticated unless the envelope is GOOD.
std::string vehicleOf(const snapwing_lcm::sealed_t& sealed);

}  // namespace snapwing::link
