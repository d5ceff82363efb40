/// What ends a pulse besides the operator: line, guardian, clocks, a controller that missed frames; and when it begins.
#include <gtest/gtest.h>

#include <deque>

#include "link/core_fixture.h"

namespace snapwing::link {
namespace {

using test::Core;

/// The line takes the first frame of a pulse only at the fourth attempt: the pulse keeps its length.
TEST_F(Core, PulseRunsFromTheFirstFrameThatWasWritten) {
  arm();
  beat(true);
  const double sent = now_;
  ASSERT_EQ(core_.onPulse(pulse(1, 1.0, 0.1), now_), Refusal::NONE);
  written_ = false;
  for (int i = 0; i < 3; ++i) {
    tick();
    now_ += 0.01;
    beat(true);
  }
  written_ = true;
  tick();
  const double first = now_;
  EXPECT_GT(first - sent, 0.04);
  while (core_.status().state == BridgeState::PULSE) {
    beat(true);
    tick();
  }
  EXPECT_NEAR(now_ - first, 0.1, 1e-9);
}

/// ... but never beyond what the command itself allows: too old, it is dropped with a word.
TEST_F(Core, PulseThatCannotBeginInTimeIsDropped) {
  arm();
  const double sent = now_;
  PulseCommand command = pulse(1, 1.0, 0.1);
  command.stamp.expiry = 0.06;
  ASSERT_EQ(core_.onPulse(command, now_), Refusal::NONE);
  while (now_ < sent + 0.065) {
    now_ += 0.01;
    beat(true);
    controller_.status_time = now_;
    core_.onController(controller_);
    core_.tick(now_);
    core_.onSent(core_.status().commanded_throttle <= 0.0, now_);  // the line takes all but thrust
  }
  EXPECT_EQ(core_.status().last_refusal, Refusal::STALE);
  EXPECT_EQ(core_.status().state, BridgeState::ARMED);
}

TEST_F(Core, LateOperatorIsNamed) {
  arm();
  std::deque<Stamp> on_their_way;
  for (int i = 0; i < 40 && core_.status().state != BridgeState::FAULT; ++i) {
    on_their_way.push_back(stamp());
    if (on_their_way.size() > 8) {  // 160 ms later
      core_.onHeartbeat({on_their_way.front(), true, true, false}, now_);
      on_their_way.pop_front();
    }
    tick();
  }
  EXPECT_EQ(core_.status().fault, Fault::OPERATOR_LATE);
  EXPECT_EQ(describe(core_.status().fault, 160000), "operator is late: its heartbeats arrive 160 ms old");
}

TEST_F(Core, WithoutAGuardianNothingIsArmedAndAPulseEnds) {
  arm();
  ASSERT_EQ(core_.onPulse(pulse(1, 1.0, 0.5), now_), Refusal::NONE);
  beat(true);
  tick();
  ASSERT_EQ(core_.status().state, BridgeState::PULSE);
  core_.onGuardian(false);
  tick();
  EXPECT_EQ(core_.status().fault, Fault::GUARDIAN_LOST);
  EXPECT_TRUE(safe());
  run(0.2, false);
  beat(false, true, true);
  EXPECT_EQ(core_.status().state, BridgeState::FAULT) << "cannot be reset";
  core_.onGuardian(true);
  beat(false, true, false);
  beat(false, true, true);
  EXPECT_EQ(core_.status().state, BridgeState::IDLE);
  core_.onGuardian(false);
  beat(false);
  beat(true);
  EXPECT_EQ(core_.status().last_refusal, Refusal::NO_GUARDIAN);
}

TEST_F(Core, ClockJumpEndsThePulseAndNothingElse) {
  core_.onClockJump(3.0);
  EXPECT_EQ(core_.status().state, BridgeState::IDLE);
  arm();
  ASSERT_EQ(core_.onPulse(pulse(1, 1.0, 0.5), now_), Refusal::NONE);
  core_.onClockJump(3.0);
  tick();
  EXPECT_EQ(core_.status().fault, Fault::CLOCKS_DISAGREE);
  EXPECT_TRUE(safe());
}

/// What no clock here saw, the controller did.
TEST_F(Core, ControllerThatMissedFramesEndsThePulse) {
  arm();
  ASSERT_EQ(core_.onPulse(pulse(1, 1.0, 0.5), now_), Refusal::NONE);
  beat(true);
  tick();
  controller_.arming_flags = RXLOSS_FLAG;
  beat(true);
  tick();
  EXPECT_EQ(core_.status().fault, Fault::CONTROLLER_RXLOSS);
  EXPECT_TRUE(safe());
}

}  // namespace
}  // namespace snapwing::link
