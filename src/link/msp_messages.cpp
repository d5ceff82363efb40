#include "snapwing/link/msp_messages.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace snapwing::link {
namespace {

/// Takes little-endian numbers from a payload; remembers if it ran out.
class Reader {
 public:
  explicit Reader(const MspPacket& packet) : packet_(packet) {}
  std::uint64_t take(std::size_t bytes) {
    if (at_ + bytes > packet_.size) {
      good_ = false;
      return 0;
    }
    std::uint64_t value = 0;
    for (std::size_t k = 0; k < bytes; ++k) value |= static_cast<std::uint64_t>(packet_.payload[at_ + k]) << (8 * k);
    at_ += bytes;
    return value;
  }
  int integer(std::size_t bytes) { return static_cast<int>(take(bytes)); }
  bool good() const { return good_; }

 private:
  const MspPacket& packet_;
  std::size_t at_ = 0;
  bool good_ = true;
};

void put(MspPacket& packet, std::uint64_t value, std::size_t bytes) {
  for (std::size_t k = 0; k < bytes; ++k) packet.payload[packet.size++] = static_cast<std::uint8_t>(value >> (8 * k));
}

std::uint64_t tenths(double seconds) { return static_cast<std::uint64_t>(std::max(0L, std::lround(10.0 * seconds))); }

}  // namespace

int BoxIds::find(std::uint8_t id) const {
  for (int i = 0; i < count; ++i) {
    if (ids[static_cast<std::size_t>(i)] == id) return i;
  }
  return -1;
}

MspPacket request(MspVersion version, std::uint16_t id) {
  MspPacket packet;
  packet.version = version;
  packet.id = id;
  return packet;
}

MspPacket setRawRc(MspVersion version, const Channels& channels) {
  MspPacket packet = request(version, MSP_SET_RAW_RC);
  encode(channels, packet);
  return packet;
}

bool decode(const MspPacket& packet, ApiVersion& out) {
  Reader reader(packet);
  ApiVersion read;
  read.protocol = reader.integer(1);
  read.major = reader.integer(1);
  read.minor = reader.integer(1);
  if (reader.good()) out = read;
  return reader.good();
}

bool decode(const MspPacket& packet, FailsafeConfig& out) {
  Reader reader(packet);
  FailsafeConfig read;
  read.delay = 0.1 * reader.integer(1);
  read.landing_time = 0.1 * reader.integer(1);
  read.throttle = reader.integer(2);
  read.switch_mode = reader.integer(1);
  read.low_throttle_delay = 0.1 * reader.integer(2);
  read.procedure = reader.integer(1);
  if (reader.good()) out = read;
  return reader.good();
}

bool decode(const MspPacket& packet, StatusReply& out) {
  Reader reader(packet);
  StatusReply read;
  read.cycle_time = reader.integer(2);
  reader.take(2 + 2);  // i2c errors, sensors
  read.modes = reader.take(4);
  reader.take(1 + 2 + 2);  // profile, load, 0
  const int more = reader.integer(1);
  for (int k = 0; k < more; ++k) {
    const std::uint64_t byte = reader.take(1);
    if (k < 4) read.modes |= byte << (32 + 8 * k);
  }
  read.arming_flag_count = reader.integer(1);
  read.arming_flags = static_cast<std::uint32_t>(reader.take(4));
  if (reader.good()) out = read;
  return reader.good();
}

bool decode(const MspPacket& packet, BoxIds& out) {
  if (packet.size == 0 || packet.size > out.ids.size()) return false;
  out.count = static_cast<int>(packet.size);
  std::copy_n(packet.payload.begin(), packet.size, out.ids.begin());
  return true;
}

bool decode(const MspPacket& packet, RxMap& out) {
  if (packet.size < 4) return false;
  out.map = DEFAULT_RX_MAP;
  out.count = packet.size < out.map.size() ? 4 : 8;
  std::copy_n(packet.payload.begin(), out.count, out.map.begin());
  return true;
}

bool decode(const MspPacket& packet, Channels& out) {
  if (packet.size < 2 || packet.size % 2 != 0) return false;
  Reader reader(packet);
  out.count = static_cast<int>(std::min<std::size_t>(packet.size / 2, MAX_CHANNELS));
  for (int i = 0; i < out.count; ++i) out.us[static_cast<std::size_t>(i)] = static_cast<std::uint16_t>(reader.take(2));
  return true;
}

void encode(const ApiVersion& in, MspPacket& packet) {
  packet.size = 0;
  put(packet, static_cast<std::uint64_t>(in.protocol), 1);
  put(packet, static_cast<std::uint64_t>(in.major), 1);
  put(packet, static_cast<std::uint64_t>(in.minor), 1);
}

void encode(const FailsafeConfig& in, MspPacket& packet) {
  packet.size = 0;
  put(packet, tenths(in.delay), 1);
  put(packet, tenths(in.landing_time), 1);
  put(packet, static_cast<std::uint64_t>(in.throttle), 2);
  put(packet, static_cast<std::uint64_t>(in.switch_mode), 1);
  put(packet, tenths(in.low_throttle_delay), 2);
  put(packet, static_cast<std::uint64_t>(in.procedure), 1);
}

void encode(const StatusReply& in, MspPacket& packet) {
  packet.size = 0;
  put(packet, static_cast<std::uint64_t>(in.cycle_time), 2);
  put(packet, 0, 2);  // i2c errors
  put(packet, 0, 2);  // sensors
  put(packet, in.modes & 0xFFFFFFFFU, 4);
  put(packet, 0, 1 + 2 + 2);  // profile, load, 0
  put(packet, 4, 1);
  put(packet, in.modes >> 32, 4);
  put(packet, static_cast<std::uint64_t>(in.arming_flag_count), 1);
  put(packet, in.arming_flags, 4);
  put(packet, 0, 1);  // config state
  put(packet, 0, 2);  // temperature
}

void encode(const BoxIds& in, MspPacket& packet) {
  packet.size = static_cast<std::size_t>(std::clamp(in.count, 0, 64));
  std::copy_n(in.ids.begin(), packet.size, packet.payload.begin());
}

void encode(const RxMap& in, MspPacket& packet) {
  packet.size = static_cast<std::size_t>(in.count);
  std::copy_n(in.map.begin(), packet.size, packet.payload.begin());
}

void encode(const Channels& in, MspPacket& packet) {
  packet.size = 0;
  const int count = std::clamp(in.count, 0, MAX_CHANNELS);
  for (int i = 0; i < count; ++i) put(packet, in.us[static_cast<std::size_t>(i)], 2);
}

}  // namespace snapwing::link
