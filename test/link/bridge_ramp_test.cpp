/// The ramp of the throttle, and the settings' ranges.
#include <gtest/gtest.h>

#include "bridge_core.h"
#include "snapwing/common/error.h"

namespace snapwing::link {
namespace {

constexpr std::int64_t SESSION = 42, SENDER = 7;

TEST(BridgeCoreRamp, RisesAtTheGivenRateAndFallsAtOnce) {
  BridgeSettings settings;
  settings.throttle_rise = 0.2;
  BridgeCore core(settings, SESSION, 0.0);
  ControllerState controller;
  controller.connected = controller.known = true;
  double now = 0;
  std::int64_t number = 0;
  const auto stamp = [&](std::int64_t count) {
    return Stamp{SENDER, SESSION, count, core.status().frame_time, 0.1, core.status().number, 0.0};
  };
  const auto step = [&](bool arm) {
    now = core.nextFrameTime();
    core.onHeartbeat({stamp(++number), arm, true, false}, now);
    controller.status_time = now;
    controller.armed = core.status().channels.us[AUX1] > 1700;
    core.onController(controller);
    core.tick(now);
    core.onSent(true, now);
  };
  for (int i = 0; i < 5; ++i) step(false);
  for (int i = 0; i < 5; ++i) step(true);
  PulseCommand command;
  command.stamp = stamp(1);
  command.pulse_id = 1;
  command.throttle = 1.0;
  command.duration = 0.3;
  ASSERT_EQ(core.onPulse(command, now), Refusal::NONE);
  double before = 0;
  for (int i = 0; i < 10; ++i) {
    step(true);
    EXPECT_NEAR(core.status().commanded_throttle - before, 0.1, 1e-6);
    before = core.status().commanded_throttle;
  }
  while (core.status().state == BridgeState::PULSE) step(true);
  EXPECT_EQ(core.status().commanded_throttle, 0.0);
}

TEST(BridgeSettings, OutOfRangeNamesTheKey) {
  BridgeSettings settings;
  settings.heartbeat_timeout = 1.0;
  try {
    settings.validate();
    FAIL();
  } catch (const common::SettingError& error) {
    EXPECT_EQ(error.key(), "heartbeat_timeout");
  }
}

}  // namespace
}  // namespace snapwing::link
