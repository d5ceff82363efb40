/// A pulse with a second level behind it: one command, two levels, one deadline.
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "link/core_fixture.h"
#include "link/loop_simulation.h"

namespace snapwing::link::test {
namespace {

/// A throttle that was sent, and how long [s].
struct Level {
  int microseconds;
  double seconds;
};

class Hold : public Core {
 protected:
  explicit Hold(const BridgeSettings& settings = {}) : Core(settings) {}

  /// Goes on until the pulse is over.
  std::vector<Level> levels(double at_most) {
    std::vector<Level> found;
    const double begin = now_;
    while (now_ - begin < at_most) {
      const double before = now_;
      const int sent = core_.status().channels.us[THROTTLE];
      beat(true);
      tick();
      if (found.empty() || found.back().microseconds != sent) found.push_back({sent, 0.0});
      found.back().seconds += now_ - before;
      if (core_.status().state != BridgeState::PULSE) break;
    }
    return found;
  }
  void expectLevels(const Level& pulse, const Level& hold) {
    const std::vector<Level> sent = levels(1.0);
    ASSERT_EQ(sent.size(), 2U);
    EXPECT_EQ(sent[0].microseconds, pulse.microseconds);
    EXPECT_NEAR(sent[0].seconds, pulse.seconds, 1e-9);
    EXPECT_EQ(sent[1].microseconds, hold.microseconds);
    EXPECT_NEAR(sent[1].seconds, hold.seconds, 1e-9);
  }
  void begin(const PulseCommand& command) {
    ASSERT_EQ(core_.onPulse(command, now_), Refusal::NONE);
    beat(true);
    tick();
  }
};

TEST_F(Hold, BothLevelsHaveTheirExactLength) {
  arm();
  begin(held(1, 0.5, 0.133, 0.25, 0.317));
  expectLevels({1500, 0.133}, {1250, 0.317});
  EXPECT_EQ(core_.status().state, BridgeState::ARMED);
  EXPECT_EQ(core_.status().channels.us[THROTTLE], 1000);
}

TEST_F(Hold, LevelAboveThePulseIsHeldAsWell) {
  arm();
  begin(held(1, 0.25, 0.2, 0.5, 0.2));
  expectLevels({1250, 0.2}, {1500, 0.2});
}

/// Whatever ends a pulse ends its hold: the next frame is low.
TEST_F(Hold, EachCauseThatEndsAPulseEndsTheHold) {
  for (int cause = 0; cause < 7; ++cause) {
    SCOPED_TRACE(cause);
    controller_ = {};
    controller_.connected = controller_.known = true;
    core_ = BridgeCore({}, SESSION, now_);
    number_ = 0;
    arm();
    begin(held(1, 0.5, 0.1, 0.3, 1.0));
    run(0.2, true);
    ASSERT_EQ(core_.status().state, BridgeState::PULSE);
    ASSERT_EQ(core_.status().channels.us[THROTTLE], 1300);
    switch (cause) {
      case 0:
        core_.onAbort({stamp(), 1}, now_);
        break;
      case 1:
        beat(true, false);
        break;
      case 2:
        beat(false);
        break;
      case 3:
        core_.onGuardian(false);
        break;
      case 4:
        core_.onClockJump(5.0);
        break;
      case 5:
        controller_.failsafe = true;
        break;
      default:
        core_.requestShutdown(now_);
    }
    tick();
    EXPECT_EQ(core_.status().channels.us[THROTTLE], 1000);
    EXPECT_NE(core_.status().state, BridgeState::PULSE);
    beat(true);
    tick();
    EXPECT_EQ(core_.status().channels.us[THROTTLE], 1000) << "it does not come back";
  }
}

TEST_F(Hold, SilentOperatorEndsIt) {
  arm();
  begin(held(1, 0.5, 0.1, 0.3, 1.3));
  run(0.15, true);
  const double last = now_;
  while (core_.status().state == BridgeState::PULSE && now_ - last < 1.0) tick();
  EXPECT_EQ(core_.status().fault, Fault::HEARTBEAT_LOST);
  EXPECT_LE(now_ - last, 0.2 + 0.041);
  EXPECT_TRUE(safe());
}

TEST_F(Hold, NothingFollowsItUntilTheRestIsOver) {
  arm();
  begin(held(1, 0.5, 0.1, 0.3, 0.2));
  run(0.15, true);
  EXPECT_EQ(core_.onPulse(pulse(2, 0.5, 0.1), now_), Refusal::BUSY) << "not in the hold either";
  run(0.2, true);
  EXPECT_EQ(core_.status().state, BridgeState::ARMED);
  EXPECT_EQ(core_.onPulse(pulse(3, 0.5, 0.1), now_), Refusal::BUSY);
}

TEST_F(Hold, BothLevelsAreCheckedBeforeTheFirstFrame) {
  constexpr double NONE = 0, NAN_VALUE = std::numeric_limits<double>::quiet_NaN();
  constexpr double INFINITE = std::numeric_limits<double>::infinity();
  const BridgeSettings settings;
  arm();
  const double longest = settings.max_pulse - 0.2;
  const std::pair<double, double> bad[] = {
      {0.3, NONE},     {NONE, 0.3},   {-0.3, 0.3},      {0.3, -0.3},      {1.001, 0.3},      {0.3, longest + 1e-6},
      {0.3, INFINITE}, {INFINITE, 1}, {NAN_VALUE, 0.3}, {0.3, NAN_VALUE}, {NAN_VALUE, NONE}, {NONE, NAN_VALUE}};
  std::int64_t id = 0;
  for (const auto& [throttle, duration] : bad) {
    SCOPED_TRACE(std::to_string(throttle) + " for " + std::to_string(duration));
    EXPECT_EQ(core_.onPulse(held(++id, 0.5, 0.2, throttle, duration), now_), Refusal::BAD_VALUE);
    run(0.02, true);
    EXPECT_EQ(core_.status().channels.us[THROTTLE], 1000);
  }
  EXPECT_EQ(core_.onPulse(held(++id, 0.5, 0.2, 0.3, longest - 1e-9), now_), Refusal::NONE);
}

TEST_F(Hold, FrameThatTheLineDidNotTakeAtTheChangeIsMadeUpForByTheNext) {
  arm();
  begin(held(1, 0.5, 0.1, 0.3, 0.4));
  const double start = now_;
  while (now_ - start < 0.095) {
    beat(true);
    tick();
    written_ = now_ - start < 0.08;
  }
  written_ = true;
  beat(true);
  tick();
  EXPECT_EQ(core_.status().channels.us[THROTTLE], 1300);
  const std::vector<Level> rest = levels(1.0);
  EXPECT_NEAR(now_ - start, 0.5, 1e-9) << "the deadline is one for both";
}

class MixedHold : public Hold {
 protected:
  static BridgeSettings settings() {
    BridgeSettings s;
    s.max_pitch = 0.5;
    s.max_throttle = 0.8;
    return s;
  }
  MixedHold() : Hold(settings()) {}
};

TEST_F(MixedHold, PitchIsCentredInTheHold) {
  arm();
  PulseCommand command = held(1, 0.5, 0.1, 0.3, 0.2);
  command.mixed = true;
  command.pitch = 0.4;
  begin(command);
  EXPECT_NE(core_.status().channels.us[PITCH], 1500);
  run(0.12, true);
  EXPECT_EQ(core_.status().channels.us[THROTTLE], 1300);
  EXPECT_EQ(core_.status().channels.us[PITCH], 1500);
}

TEST_F(MixedHold, LimitOfTheThrottleHoldsForBothLevels) {
  arm();
  EXPECT_EQ(core_.onPulse(held(1, 0.5, 0.1, 0.81, 0.2), now_), Refusal::BAD_VALUE);
}

/// Through the loop, on the stand-in's line: what the motors do.
TEST(BridgeLoop, MotorsFollowPulseAndHold) {
  constexpr double BETWEEN_LEVELS = 1430, ABOVE_IDLE = 1180;  // [us] outputs
  Simulation s;
  s.arm();
  s.run(0.3);
  PulseShape shape;
  shape.throttle = 0.6, shape.duration = 0.14;
  shape.hold_throttle = 0.25, shape.hold_duration = 0.63;
  s.command(shape);
  double pulse = 0, hold = 0;
  s.run(1.0, [&] {
    const double motor = s.fc.motorMicroseconds();
    if (motor > BETWEEN_LEVELS) pulse += 1e-3;
    if (motor > ABOVE_IDLE && motor <= BETWEEN_LEVELS) hold += 1e-3;
  });
  EXPECT_NEAR(pulse, shape.duration, 0.015);
  EXPECT_NEAR(hold, shape.hold_duration, 0.015);
  EXPECT_EQ(s.bridge->core().status().fault, Fault::NONE);
  EXPECT_EQ(s.port.lostBytes(), 0);
}

}  // namespace
}  // namespace snapwing::link::test
