/// libFuzzer: bytes from the line into every parser and payload decoder.
#include <cstdint>
#include <cstdlib>

#include "snapwing/link/crsf.h"
#include "snapwing/link/motor_stream.h"
#include "snapwing/link/msp_messages.h"
#include "snapwing/link/sbus.h"

using namespace snapwing::link;

namespace {

void require(bool good) {
  if (!good) std::abort();
}

void decodeAll(const MspPacket& packet) {
  ApiVersion api;
  FailsafeConfig failsafe;
  StatusReply status;
  BoxIds boxes;
  RxMap map;
  Channels channels;
  decode(packet, api);
  decode(packet, failsafe);
  decode(packet, status);
  if (decode(packet, boxes)) require(boxes.count <= 64 && boxes.find(BOX_ARM) < boxes.count);
  decode(packet, map);
  if (decode(packet, channels)) require(channels.count >= 1 && channels.count <= MAX_CHANNELS);
}

/// What was accepted must encode to a frame that is accepted again, with the same content.
void roundTrip(const MspPacket& packet) {
  std::array<std::uint8_t, MSP_MAX_FRAME> bytes{};
  const std::size_t size = encodeMsp(packet, bytes.data(), bytes.size());
  if (size == 0) return;
  MspParser again;
  int found = 0;
  for (std::size_t i = 0; i < size; ++i) found += again.push(bytes[i]) ? 1 : 0;
  require(found == 1 && again.packet().id == packet.id && again.packet().size == packet.size);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  MspParser msp;
  SbusParser sbus;
  CrsfParser crsf;
  double now = 0;
  for (std::size_t i = 0; i < size; ++i) {
    if (msp.push(data[i])) {
      require(msp.packet().size <= MSP_MAX_PAYLOAD);
      decodeAll(msp.packet());
      roundTrip(msp.packet());
    }
    now += data[i] == 0xFF ? 0.01 : 0.0001;
    if (sbus.push(data[i], now)) {
      for (const std::uint16_t tick : sbus.frame().ticks) require(tick < 2048);
    }
    if (crsf.push(data[i])) {
      for (const std::uint16_t tick : crsf.ticks()) require(tick < 2048);
    }
  }
  MotorOutputs motors{};
  if (decodeMotors(data, size, motors)) {
    for (const double output : motors) require(output >= 0.0 && output <= 1.0);
  }
  return 0;
}
