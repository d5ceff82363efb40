/// libFuzzer: bytes from a flight controller gone mad into the bridge's view of it, and bytes from a mad bridge into
/// the stand-in. Neither may crash, and nonsense alone may never make the stand-in's motors turn without AUX1 high and
/// low throttle first.
#include <cstdint>
#include <cstdlib>

#include "controller_watch.h"
#include "standin_controller.h"

using namespace snapwing::link;
using namespace snapwing::standin;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ControllerWatch watch(MspVersion::V2, {});
  MspParser parser;
  watch.connected(0.0);
  StandinController fc(StandinSettings{}, 0.0);
  StandinMsp port(fc, 0.0);
  std::uint8_t out[1024];
  double now = 0;
  for (std::size_t i = 0; i < size; ++i) {
    if (parser.push(data[i])) watch.onPacket(parser.packet(), now);
    MspPacket question;
    watch.nextRequest(now, question);
    port.receive(data + i, 1);
    now += 0.001;
    if (port.step(now, out, sizeof out) > sizeof out) std::abort();
    if (watch.state().motor_max > 0xFFFF || fc.motorMicroseconds() < 1000 || fc.motorMicroseconds() > 2000)
      std::abort();
    if (!fc.armed() && fc.motorMicroseconds() != 1000) std::abort();
  }
  return 0;
}
