/// libFuzzer: any sequence of authenticated messages, controller states, times and lost frames into the bridge's core.
/// After every frame the rules that keep people whole must hold.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "bridge_core.h"

using namespace snapwing::link;

namespace {

void require(bool good) {
  if (!good) std::abort();
}

/// Numbers from the input; zeros when it is used up.
class Source {
 public:
  Source(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}
  bool empty() const { return left_ == 0; }
  std::uint8_t byte() {
    if (left_ == 0) return 0;
    --left_;
    return *data_++;
  }
  /// Any double at all, NaN and infinities included, or a sensible one.
  double number() {
    if (byte() % 4 != 0) return byte() / 128.0;
    std::uint64_t bits = 0;
    for (int i = 0; i < 8; ++i) bits = bits << 8 | byte();
    double value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};

class Driver {
 public:
  Driver(const std::uint8_t* data, std::size_t size)
      : source_(data, size), settings_(settings(source_.byte() % 4 == 0)), core_(settings_, SESSION, 10.0) {
    controller_.connected = controller_.known = true;
  }

  void run() {
    while (!source_.empty()) {
      switch (source_.byte() % 8) {
        case 0:
          pulse();
          break;
        case 1:
        case 2:
          core_.onHeartbeat({stamp(), source_.byte() % 4 != 0, source_.byte() % 8 != 0, source_.byte() % 8 == 0}, now_);
          break;
        case 3:
          if (source_.byte() % 8 == 0) core_.onAbort({stamp(), source_.byte()}, now_);
          break;
        case 4:
          disturb();
          break;
        default:
          frame();
      }
    }
  }

 private:
  static constexpr std::int64_t SESSION = 5;
  static BridgeSettings settings(bool pilot_override) {
    BridgeSettings settings;
    settings.pilot_override = pilot_override;
    settings.max_throttle = 0.9;
    settings.max_pulse = 0.8;
    settings.max_pitch = 0.5;
    return settings;
  }

  Stamp stamp() {
    const std::uint8_t kind = source_.byte();
    const BridgeStatus& heard = core_.status();
    Stamp stamp{1 + kind % 2, SESSION, ++number_, heard.frame_time, 0.1, heard.number, 0.0};
    if (kind == 240) stamp.held = source_.number();
    if (kind == 235) stamp.status_number = source_.byte();
    if (kind > 240) stamp.time = source_.number();
    if (kind == 239) stamp.expiry = source_.number();
    if (kind == 238) stamp.session = source_.byte();
    if (kind == 237) stamp.number = source_.byte();
    if (kind == 236) stamp.sender_id = source_.byte();
    return stamp;
  }

  void pulse() {
    PulseCommand command;
    command.stamp = stamp();
    command.pulse_id = ++pulse_;
    command.throttle = source_.number();
    command.duration = source_.number();
    if (source_.byte() % 2 == 0) {
      command.hold_throttle = source_.number();
      command.hold_duration = source_.number();
    }
    command.mixed = source_.byte() % 8 == 0;
    command.pitch = source_.number();
    const Refusal refusal = core_.onPulse(command, now_);
    if (refusal != Refusal::NONE) return;
    require(command.throttle >= 0 && command.throttle <= 0.9 && command.duration > 0 && command.duration <= 0.8);
    require(command.hold_throttle >= 0 && command.hold_throttle <= 0.9 && command.hold_duration >= 0);
    require(command.whole() <= 0.8 && (command.hold_throttle > 0) == (command.hold_duration > 0));
    require(std::isfinite(command.stamp.time) && now_ - command.stamp.time <= 0.1 + 1e-9);
    accepted_end_ = now_ + 0.1 + command.whole();
  }

  void disturb() {
    const std::uint8_t kind = source_.byte();
    controller_.connected = kind % 16 != 1;
    controller_.known = kind % 16 != 2;
    controller_.failsafe = kind % 16 == 3;
    controller_.arming_flags = kind % 16 == 4 ? source_.byte() : 0;
    follow_ = kind % 16 != 5;
    controller_.override_active = kind % 16 != 9;
    written_ = kind % 16 != 6;
    if (kind % 16 == 7) now_ += source_.byte() / 100.0;
    if (kind == 8) core_.requestShutdown(now_);
  }

  void frame() {
    require(std::isfinite(core_.nextFrameTime()) && core_.nextFrameTime() - now_ < 0.06);
    const bool hurry = core_.urgent() && source_.byte() % 2 == 0;
    require(core_.earliestFrameTime() <= core_.nextFrameTime());
    now_ = std::max(now_, hurry ? core_.earliestFrameTime() : core_.nextFrameTime());
    if (follow_) {
      controller_.armed = settings_.pilot_override || core_.status().channels.us[AUX1] > 1700;
      controller_.status_time = now_;
    }
    core_.onController(controller_);
    const Channels& channels = core_.tick(now_);
    core_.onSent(written_, now_);
    check(channels);
  }

  void check(const Channels& channels) const {
    const BridgeStatus& status = core_.status();
    require(channels.count == FRAME_CHANNELS);
    for (int i = 0; i < channels.count; ++i) {
      const int us = channels.us[static_cast<std::size_t>(i)];
      require(us >= CHANNEL_LOW && us <= CHANNEL_HIGH);
    }
    const bool thrust = channels.us[THROTTLE] > CHANNEL_LOW;
    const bool active = status.state == BridgeState::ARMED || status.state == BridgeState::PULSE;
    require(!thrust || status.state == BridgeState::PULSE);
    require(!thrust || now_ < accepted_end_ + 1e-6);
    require(channels.us[THROTTLE] <= 1900);
    require((channels.us[AUX1] > CHANNEL_LOW) == (active && !settings_.pilot_override));
    require(!thrust || !settings_.pilot_override || (controller_.override_active && controller_.armed));
    require(std::abs(channels.us[PITCH] - CHANNEL_CENTRE) <= 250);
    require(status.state != BridgeState::FAULT || status.fault != Fault::NONE);
  }

  Source source_;
  BridgeSettings settings_;
  BridgeCore core_;
  ControllerState controller_;
  double now_ = 10.0, accepted_end_ = 0;
  std::int64_t number_ = 0, pulse_ = 0;
  bool follow_ = true, written_ = true;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Driver(data, size).run();
  return 0;
}
