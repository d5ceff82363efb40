#pragma once
/// A bridge's core on a fake clock, with an operator that beats and a controller that follows.

#include <gtest/gtest.h>

#include <algorithm>

#include "bridge_core.h"

namespace snapwing::link::test {

inline constexpr std::int64_t SESSION = 42, SENDER = 7;

class Core : public ::testing::Test {
 protected:
  explicit Core(const BridgeSettings& settings = {}) : core_(settings, SESSION, 100.0) {
    controller_.connected = true;
    controller_.known = true;
  }

  /// As a sender makes it that has heard the newest status; before the first there is nothing to answer.
  Stamp stamp(std::int64_t sender = SENDER) {
    if (core_.status().number == 0) tick();
    return {sender,
            SESSION,
            ++number_,
            core_.status().frame_time,
            0.1,
            core_.status().number,
            now_ - core_.status().frame_time};
  }
  PulseCommand pulse(std::int64_t id, double throttle, double duration) {
    PulseCommand command;
    command.stamp = stamp();
    command.pulse_id = id;
    command.throttle = throttle;
    command.duration = duration;
    return command;
  }
  PulseCommand held(std::int64_t id, double throttle, double duration, double hold_throttle, double hold_duration) {
    PulseCommand command = pulse(id, throttle, duration);
    command.hold_throttle = hold_throttle;
    command.hold_duration = hold_duration;
    return command;
  }
  Refusal beat(bool arm, bool deadman = true, bool reset = false, std::int64_t sender = SENDER) {
    return core_.onHeartbeat({stamp(sender), arm, deadman, reset}, now_);
  }
  /// One frame; the controller follows AUX1 at once and reports it.
  const Channels& tick() {
    now_ = std::max(now_, core_.nextFrameTime());
    controller_.status_time = now_;
    if (follow_) controller_.armed = core_.status().channels.us[AUX1] > 1700;
    core_.onController(controller_);
    const Channels& channels = core_.tick(now_);
    core_.onSent(written_, now_);
    return channels;
  }
  void run(double seconds, bool arm, bool deadman = true) {
    const double end = now_ + seconds;
    while (now_ < end - 1e-9) {
      beat(arm, deadman);
      tick();
    }
  }
  void arm() {
    run(0.1, false);
    run(0.1, true);
    ASSERT_EQ(core_.status().state, BridgeState::ARMED);
    ASSERT_TRUE(controller_.armed);
  }
  bool safe() const {
    const Channels& c = core_.status().channels;
    return c.us[THROTTLE] == 1000 && c.us[AUX1] == 1000 && c.us[PITCH] == 1500 && c.count == FRAME_CHANNELS;
  }

  double now_ = 100.0;
  std::int64_t number_ = 0;
  ControllerState controller_;
  bool follow_ = true, written_ = true;
  BridgeCore core_;
};

}  // namespace snapwing::link::test
