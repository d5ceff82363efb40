#include "standin_port.h"

namespace snapwing::standin {

StandinPort::StandinPort(const std::string& protocol, StandinController& controller, double now)
    : protocol_(protocol), controller_(controller), msp_(controller, now) {}

void StandinPort::take(const std::uint8_t* bytes, std::size_t size, double now) {
  if (protocol_ == "msp") return msp_.receive(bytes, size);
  for (std::size_t i = 0; i < size; ++i) {
    if (protocol_ == "sbus") {
      if (sbus_.push(bytes[i], now) && sbus_.frame().usable())
        onTicks(sbus_.frame().ticks, link::sbusMicroseconds, now);
    } else if (crsf_.push(bytes[i])) {
      onTicks(crsf_.ticks(), link::crsfMicroseconds, now);
    }
  }
}

void StandinPort::onTicks(const link::Ticks& ticks, int (*microseconds)(int), double now) {
  link::Channels channels;
  channels.count = link::MAX_CHANNELS;
  for (std::size_t i = 0; i < ticks.size(); ++i) channels.us[i] = static_cast<std::uint16_t>(microseconds(ticks[i]));
  controller_->onFrame(channels, now);
}

}  // namespace snapwing::standin
