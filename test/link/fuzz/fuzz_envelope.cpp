/// libFuzzer: datagrams into the envelope. The input is tried as it comes, which must never get in, and as the payload
/// of an envelope sealed with the right key, to reach the decoders behind the authentication.
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "lcm_messages.h"
#include "snapwing/link/sealing.h"

using namespace snapwing::link;

namespace {

void require(bool good) {
  if (!good) std::abort();
}

template <class Wire, class Plain>
bool take(const Sealer& sealer, const char* channel, const void* bytes, std::size_t size) {
  Wire wire;
  Plain plain;
  return sealer.unwrap(channel, bytes, size, wire) && fromLcm(wire, plain);
}

bool takeAny(const Sealer& sealer, const char* channel, const void* bytes, std::size_t size) {
  bool taken = take<snapwing_lcm::pulse_command_t, PulseCommand>(sealer, channel, bytes, size);
  taken |= take<snapwing_lcm::heartbeat_t, Heartbeat>(sealer, channel, bytes, size);
  taken |= take<snapwing_lcm::abort_t, Abort>(sealer, channel, bytes, size);
  taken |= take<snapwing_lcm::link_status_t, BridgeStatus>(sealer, channel, bytes, size);
  snapwing_lcm::telemetry_t telemetry;
  return taken | sealer.unwrap(channel, bytes, size, telemetry);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Key key;
  key.fill(0x5A);
  const Sealer sealer(key);
  require(!takeAny(sealer, CHANNEL_PULSE, data, size));
  snapwing_lcm::sealed_t sealed{};
  if (!sealer.seal(CHANNEL_PULSE, data, size, sealed)) return 0;
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(sealed.getEncodedSize()));
  sealed.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  takeAny(sealer, CHANNEL_PULSE, bytes.data(), bytes.size());
  return 0;
}
