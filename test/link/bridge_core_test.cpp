/// The bridge's state machine on a fake clock.
#include "bridge_core.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "link/core_fixture.h"
#include "snapwing/common/error.h"

namespace snapwing::link {
namespace {

using test::Core;
using test::SENDER;
using test::SESSION;

TEST_F(Core, SafeFramesAtFiftyHertzFromTheStart) {
  for (int i = 0; i < 100; ++i) {
    EXPECT_NEAR(core_.nextFrameTime(), 100.0 + 0.02 * i, 1e-9);
    tick();
    ASSERT_TRUE(safe());
  }
}

TEST_F(Core, ArmsOnlyAfterTheSwitchWasOff) {
  tick();
  EXPECT_EQ(beat(true), Refusal::SWITCH_NOT_CYCLED);
  run(0.5, true);
  EXPECT_EQ(core_.status().state, BridgeState::IDLE);
  EXPECT_EQ(core_.status().commands_refused, 1) << "counted once, not with every heartbeat";
  run(0.1, false);
  run(0.1, true);
  EXPECT_EQ(core_.status().state, BridgeState::ARMED);
  EXPECT_EQ(core_.status().channels.us[AUX1], 2000);
  EXPECT_EQ(core_.status().channels.us[THROTTLE], 1000);
}

TEST_F(Core, ArmingInterlocks) {
  const auto attempt = [this] {
    run(0.06, false);
    const Refusal refusal = beat(true);
    tick();
    return refusal;
  };
  controller_.connected = false;
  EXPECT_EQ(attempt(), Refusal::NOT_CONNECTED);
  controller_.connected = true;
  controller_.known = false;
  EXPECT_EQ(attempt(), Refusal::CONTROLLER_UNKNOWN);
  controller_.known = true;
  controller_.arming_flags = 1U << 9;
  EXPECT_EQ(attempt(), Refusal::CONTROLLER_NOT_READY);
  EXPECT_NE(describe(core_.status().last_refusal, core_.status().last_refusal_detail).find("BOOTGRACE"),
            std::string::npos);
  controller_.arming_flags = 0;
  controller_.failsafe = true;
  EXPECT_EQ(attempt(), Refusal::CONTROLLER_FAILSAFE);
  controller_.failsafe = false;
  written_ = false;
  EXPECT_EQ((run(0.2, false), attempt()), Refusal::NOT_CONNECTED);
  written_ = true;
  follow_ = false;
  controller_.armed = true;
  EXPECT_EQ(attempt(), Refusal::CONTROLLER_NOT_READY) << "armed by somebody else";
  controller_.armed = false;
  follow_ = true;
  EXPECT_EQ((beat(false), beat(true, false)), Refusal::NONE);
  tick();
  EXPECT_EQ(core_.status().state, BridgeState::IDLE) << "deadman not held";
  EXPECT_EQ(attempt(), Refusal::NONE);
  EXPECT_EQ(core_.status().state, BridgeState::ARMED);
}

TEST_F(Core, PulseHasItsExactLengthAndEndsByItself) {
  arm();
  ASSERT_EQ(core_.onPulse(pulse(1, 0.5, 0.133), now_), Refusal::NONE);
  beat(true);
  ASSERT_EQ(tick().us[THROTTLE], 1500);
  EXPECT_EQ(core_.status().state, BridgeState::PULSE);
  const double start = now_;
  while (core_.status().state == BridgeState::PULSE) {
    beat(true);
    tick();
    ASSERT_LT(now_ - start, 0.2);
  }
  EXPECT_NEAR(now_ - start, 0.133, 1e-9);
  EXPECT_EQ(core_.status().state, BridgeState::ARMED);
  EXPECT_EQ(core_.status().channels.us[THROTTLE], 1000);
  EXPECT_EQ(core_.status().channels.us[AUX1], 2000);
  const double end = now_;
  beat(true);
  tick();
  EXPECT_NEAR(now_ - end, 0.02, 1e-9);
}

TEST_F(Core, CommandToFrameTakesLessThanAPeriod) {
  arm();
  now_ += 0.0001;
  ASSERT_EQ(core_.onPulse(pulse(1, 0.5, 0.1), now_), Refusal::NONE);
  const double commanded = now_;
  beat(true);
  tick();
  EXPECT_EQ(core_.status().channels.us[THROTTLE], 1500);
  EXPECT_LT(now_ - commanded, 0.02);
  EXPECT_NEAR(core_.status().latency_worst, now_ - commanded, 1e-9);
}

/// A pulse, its abort and a released deadman do not wait for the grid; a heartbeat or a refused command does.
TEST_F(Core, MessagesThatChangeTheFrameBringItForward) {
  constexpr double GAP = 0.007;  // [s] the least between two frames
  arm();
  EXPECT_FALSE(core_.urgent());
  const auto hurried = [this] {
    EXPECT_TRUE(core_.urgent());
    const double last = now_;
    EXPECT_NEAR(core_.earliestFrameTime(), last + GAP, 1e-9);
    now_ = core_.earliestFrameTime();
    const Channels& channels = core_.tick(now_);
    core_.onSent(true, now_);
    EXPECT_FALSE(core_.urgent());
    EXPECT_NEAR(core_.nextFrameTime(), now_ + 0.02, 1e-9) << "the grid starts anew";
    return channels;
  };
  const Histogram periods = core_.status().period_histogram;
  ASSERT_EQ(core_.onPulse(pulse(1, 0.5, 0.5), now_), Refusal::NONE);
  EXPECT_EQ(hurried().us[THROTTLE], 1500);
  EXPECT_EQ(core_.status().period_histogram, periods) << "a hurried frame is not a late one";
  EXPECT_EQ(core_.status().latency_histogram[6], 1) << "5 to 10 ms";
  EXPECT_EQ(core_.onPulse(pulse(1, 0.5, 0.5), now_), Refusal::REPEATED_PULSE);
  EXPECT_EQ(core_.onPulse(pulse(MAX_PULSE_ID + 1, 0.5, 0.5), now_), Refusal::BAD_VALUE) << "ROS could send no more";
  EXPECT_EQ(core_.status().pulse_id, 1);
  EXPECT_EQ(beat(true), Refusal::NONE);
  EXPECT_FALSE(core_.urgent());
  beat(true, false);
  EXPECT_EQ(hurried().us[AUX1], 1000);
  arm();
  core_.onAbort({stamp(), 3}, now_);
  hurried();
  EXPECT_TRUE(safe());
}

TEST_F(Core, RefusesBadPulses) {
  run(0.1, false);
  EXPECT_EQ(core_.onPulse(pulse(1, 0.5, 0.1), now_), Refusal::NOT_ARMED);
  arm();
  EXPECT_EQ(core_.onPulse(pulse(2, 1.1, 0.1), now_), Refusal::BAD_VALUE);
  EXPECT_EQ(core_.onPulse(pulse(2, -0.1, 0.1), now_), Refusal::BAD_VALUE);
  EXPECT_EQ(core_.onPulse(pulse(2, std::nan(""), 0.1), now_), Refusal::BAD_VALUE);
  EXPECT_EQ(core_.onPulse(pulse(2, 0.5, 0.0), now_), Refusal::BAD_VALUE);
  EXPECT_EQ(core_.onPulse(pulse(2, 0.5, std::nan("")), now_), Refusal::BAD_VALUE);
  EXPECT_EQ(core_.onPulse(pulse(2, 0.5, 1.6), now_), Refusal::BAD_VALUE);
  EXPECT_EQ(core_.onPulse(pulse(2, 0.5, std::numeric_limits<double>::infinity()), now_), Refusal::BAD_VALUE);
  PulseCommand mixed = pulse(2, 0.5, 0.1);
  mixed.mixed = true;
  EXPECT_EQ(core_.onPulse(mixed, now_), Refusal::MIXED_NOT_ALLOWED);
  PulseCommand other = pulse(2, 0.5, 0.1);
  other.stamp.sender_id = 99;
  EXPECT_EQ(core_.onPulse(other, now_), Refusal::OTHER_OPERATOR);
  EXPECT_EQ(core_.onPulse(pulse(2, 0.5, 0.1), now_), Refusal::NONE);
  beat(true);
  tick();
  EXPECT_EQ(core_.onPulse(pulse(3, 0.5, 0.1), now_), Refusal::BUSY);
  run(0.2, true);
  EXPECT_EQ(core_.onPulse(pulse(2, 0.5, 0.1), now_), Refusal::REPEATED_PULSE);
  EXPECT_EQ(core_.onPulse(pulse(1, 0.5, 0.1), now_), Refusal::REPEATED_PULSE);
  EXPECT_EQ(core_.status().commands_refused, 13);
}

TEST_F(Core, StampsOfOldRepeatedForeignAndFutureMessages) {
  arm();
  /// As made by a sender that has heard nothing since.
  const PulseCommand held_back = pulse(1, 0.5, 0.1);
  run(0.101, true);
  PulseCommand command = held_back;
  EXPECT_EQ(core_.onPulse(command, now_), Refusal::STALE);
  EXPECT_NE(describe(Refusal::STALE, core_.status().last_refusal_detail).find("old"), std::string::npos);
  command = pulse(1, 0.5, 0.1);
  run(0.05, true);
  command.stamp.number = ++number_;
  command.stamp.expiry = 0.04;
  EXPECT_EQ(core_.onPulse(command, now_), Refusal::STALE) << "the sender's own expiry";
  command = pulse(1, 0.5, 0.1);
  run(0.2, true);
  command.stamp.number = ++number_;
  command.stamp.expiry = 10.0;
  EXPECT_EQ(core_.onPulse(command, now_), Refusal::STALE) << "no expiry extends the bridge's limit";
  command = pulse(1, 0.5, 0.1);
  command.stamp.session = SESSION + 1;
  EXPECT_EQ(core_.onPulse(command, now_), Refusal::WRONG_SESSION);
  command = pulse(1, 0.5, 0.1);
  EXPECT_EQ(core_.onPulse(command, now_), Refusal::NONE);
  EXPECT_EQ(core_.onPulse(command, now_), Refusal::REPEATED_NUMBER);
}

TEST_F(Core, CommandsMustAnswerAStatusThatWasSent) {
  arm();
  const PulseCommand old = pulse(1, 0.5, 0.1);
  run(3.0, true);
  PulseCommand command = pulse(1, 0.5, 0.1);
  command.stamp.status_number += 1;
  EXPECT_EQ(core_.onPulse(command, now_), Refusal::UNKNOWN_STATUS) << "not sent yet";
  for (const double shift : {-1.0, -0.02, -2e-6, 2e-6, 0.02, 1.0, std::nan("")}) {
    command = pulse(1, 0.5, 0.1);
    command.stamp.time += shift;
    EXPECT_EQ(core_.onPulse(command, now_), Refusal::UNKNOWN_STATUS) << shift;
  }
  command = pulse(1, 0.5, 0.1);
  command.stamp.status_number = 0;
  EXPECT_EQ(core_.onPulse(command, now_), Refusal::UNKNOWN_STATUS);
  command = old;
  EXPECT_EQ(core_.onPulse(command, now_), Refusal::STALE) << "a status so old that it is forgotten";
  command.stamp.time = now_;
  EXPECT_EQ(core_.onPulse(command, now_), Refusal::STALE) << "and its time made young";
  command.stamp.time = now_ + 0.05;
  EXPECT_EQ(core_.onPulse(command, now_), Refusal::FROM_FUTURE);
  EXPECT_EQ(core_.onPulse(pulse(1, 0.5, 0.1), now_), Refusal::NONE);
}

/// A sender's clock that runs wild changes neither a command's age nor the silence after which the bridge disarms.
TEST_F(Core, SendersClockCannotMakeACommandYounger) {
  arm();
  for (const double held : {-1e9, -1.0, 1.0, 1e9, std::numeric_limits<double>::infinity()}) {
    Heartbeat beat{stamp(), true, true, false};
    beat.stamp.held = held;
    EXPECT_EQ(core_.onHeartbeat(beat, now_), Refusal::NONE);
    tick();
    EXPECT_EQ(core_.status().state, BridgeState::ARMED) << held;
  }
  const double silent_since = now_;
  while (core_.status().state == BridgeState::ARMED && now_ < silent_since + 1.0) tick();
  EXPECT_EQ(core_.status().fault, Fault::HEARTBEAT_LOST);
  EXPECT_LE(now_ - silent_since, 0.2 + 0.02 + 1e-9);
}

TEST_F(Core, LatestCommandBeforeTheFrameWins) {
  arm();
  ASSERT_EQ(core_.onPulse(pulse(1, 0.9, 0.5), now_), Refusal::NONE);
  ASSERT_EQ(core_.onPulse(pulse(2, 0.4, 0.1), now_), Refusal::NONE);
  beat(true);
  EXPECT_EQ(tick().us[THROTTLE], 1400);
  run(0.3, true);
  EXPECT_EQ(core_.status().commanded_throttle, 0.0) << "the first one is not queued";
  EXPECT_EQ(core_.status().pulse_id, 2);
}

TEST_F(Core, AcceptedCommandThatWaitsTooLongForItsFrameIsDropped) {
  arm();
  ASSERT_EQ(core_.onPulse(pulse(1, 0.9, 0.5), now_), Refusal::NONE);
  now_ += 0.099 + 0.02;
  core_.onHeartbeat({stamp(), true, true, false}, now_);
  tick();
  EXPECT_NE(core_.status().channels.us[THROTTLE], 1900);
}

TEST_F(Core, DeadmanAndSwitchDisarmWithTheNextFrame) {
  for (const bool by_switch : {true, false}) {
    SCOPED_TRACE(by_switch);
    arm();
    ASSERT_EQ(core_.onPulse(pulse(by_switch ? 1 : 2, 1.0, 1.0), now_), Refusal::NONE);
    run(0.2, true);
    ASSERT_EQ(core_.status().state, BridgeState::PULSE);
    beat(!by_switch, by_switch);
    tick();
    EXPECT_TRUE(safe());
    EXPECT_EQ(core_.status().state, BridgeState::IDLE);
    run(0.3, true);
    EXPECT_TRUE(safe()) << "the switch left on does not arm again";
  }
}

TEST_F(Core, LostHeartbeatLatches) {
  arm();
  ASSERT_EQ(core_.onPulse(pulse(1, 1.0, 1.0), now_), Refusal::NONE);
  beat(true);
  const double last = now_;
  while (core_.status().state != BridgeState::FAULT) {
    tick();
    ASSERT_LT(now_ - last, 0.3);
  }
  EXPECT_LE(now_ - last, 0.2 + 0.02 + 1e-9);
  EXPECT_TRUE(safe());
  EXPECT_EQ(core_.status().fault, Fault::HEARTBEAT_LOST);
  run(0.5, true);
  EXPECT_TRUE(safe()) << "a heartbeat that returns does not resume";
  run(0.1, false);
  run(0.1, true);
  EXPECT_EQ(core_.status().state, BridgeState::FAULT) << "latched until reset";
  beat(false);
  beat(false, true, true);
  EXPECT_EQ(core_.status().state, BridgeState::IDLE);
  run(0.1, false);
  run(0.3, true);
  EXPECT_EQ(core_.status().state, BridgeState::ARMED);
  EXPECT_EQ(core_.status().channels.us[THROTTLE], 1000) << "the old pulse is gone";
}

/// An abort counts at any age, but once: also when so many consoles came after its sender that nothing else of it is
/// known.
TEST_F(Core, ARecordedAbortIsRefusedWhenItsSenderIsForgotten) {
  const Abort recorded{stamp(1000), 1};
  EXPECT_EQ(core_.onAbort(recorded, now_), Refusal::NONE);
  for (std::int64_t console = 1001; console < 1012; ++console) {
    for (const double end = now_ + 1.2; now_ < end; tick()) beat(false, true, false, console);
    beat(false, true, true, console);
  }
  arm();
  EXPECT_EQ(core_.onAbort(recorded, now_), Refusal::STALE);
  EXPECT_EQ(core_.status().state, BridgeState::ARMED);
  Abort deaf{stamp(2000), 1};
  run(3.0, true);
  EXPECT_EQ(core_.onAbort(deaf, now_), Refusal::NONE) << "a new sender that has heard no status for three seconds";
  EXPECT_EQ(core_.status().state, BridgeState::FAULT);
}

TEST_F(Core, AbortLatchesFromEveryStateEvenWhenLate) {
  arm();
  ASSERT_EQ(core_.onPulse(pulse(1, 1.0, 1.0), now_), Refusal::NONE);
  run(0.1, true);
  Abort abort{stamp(), 3};
  abort.stamp.time = now_ - 0.5;
  EXPECT_EQ(core_.onAbort(abort, now_), Refusal::NONE);
  beat(true);
  tick();
  EXPECT_TRUE(safe());
  EXPECT_EQ(core_.status().fault, Fault::ABORTED);
  EXPECT_EQ(core_.status().fault_detail, 3);
}

/// Half of the datagrams lost: an operator who has heard no status for 0.1 s must still be able to stop.
TEST_F(Core, LateHeartbeatOfTheOperatorStopsAndDoesNothingElse) {
  for (const bool released : {false, true}) {
    arm();
    ASSERT_EQ(core_.onPulse(pulse(released ? 2 : 1, 1.0, 1.0), now_), Refusal::NONE);
    run(0.1, true);
    const Stamp old = stamp();
    run(0.2, true);
    Heartbeat late{old, true, true, false};
    late.stamp.number = ++number_;
    EXPECT_EQ(core_.onHeartbeat(late, now_), Refusal::STALE) << "it asks for thrust";
    EXPECT_EQ(core_.status().state, BridgeState::PULSE);
    Heartbeat replayed{old, false, true, false};
    EXPECT_EQ(core_.onHeartbeat(replayed, now_), Refusal::REPEATED_NUMBER);
    Heartbeat foreign{old, false, true, false};
    foreign.stamp.sender_id = SENDER + 1;
    foreign.stamp.number = ++number_;
    EXPECT_EQ(core_.onHeartbeat(foreign, now_), Refusal::STALE);
    EXPECT_EQ(core_.status().state, BridgeState::PULSE);
    Heartbeat stop{old, released, !released, false};
    stop.stamp.number = ++number_;
    EXPECT_EQ(core_.onHeartbeat(stop, now_), Refusal::NONE);
    EXPECT_EQ(core_.status().state, BridgeState::IDLE);
    tick();
    EXPECT_TRUE(safe());
    stop.stamp.number = ++number_;
    stop.reset_fault = true;
    EXPECT_EQ(core_.onHeartbeat(stop, now_), Refusal::STALE) << "no use for anything when nothing is to be stopped";
  }
}

TEST_F(Core, OwnStallLatchesBeforeTheFirstFrameAfterIt) {
  arm();
  ASSERT_EQ(core_.onPulse(pulse(1, 1.0, 1.4), now_), Refusal::NONE);
  run(0.1, true);
  now_ += 0.6;  // stopped, then continued, with a fresh heartbeat at once
  beat(true);
  tick();
  EXPECT_TRUE(safe());
  EXPECT_EQ(core_.status().fault, Fault::LOOP_STALLED);
}

TEST_F(Core, LineAndControllerFaults) {
  struct Case {
    Fault fault;
    std::function<void()> cause;
    double within;
  };
  const std::vector<Case> cases = {
      {Fault::LINE_LOST, [this] { controller_.connected = false; }, 0.03},
      {Fault::LINE_LOST, [this] { written_ = false; }, 0.15},
      {Fault::CONTROLLER_FAILSAFE, [this] { controller_.failsafe = true; }, 0.03},
      {Fault::CONTROLLER_DISARMED, [this] { follow_ = false, controller_.armed = false; }, 0.03},
  };
  std::int64_t id = 0;
  for (const Case& c : cases) {
    SCOPED_TRACE(describe(c.fault, 0));
    beat(false);
    beat(false, true, true);
    arm();
    ASSERT_EQ(core_.onPulse(pulse(++id, 1.0, 1.0), now_), Refusal::NONE);
    run(0.1, true);
    ASSERT_EQ(core_.status().state, BridgeState::PULSE);
    const double start = now_;
    c.cause();
    while (core_.status().state != BridgeState::FAULT && now_ < start + 1.0) beat(true), tick();
    EXPECT_EQ(core_.status().fault, c.fault);
    EXPECT_LE(now_ - start, c.within);
    EXPECT_TRUE(safe());
    controller_ = ControllerState{};
    controller_.connected = controller_.known = follow_ = written_ = true;
    run(0.3, true);
    EXPECT_TRUE(safe()) << "nothing resumes when the cause is gone";
  }
}

TEST_F(Core, ControllerThatDoesNotArmOrGoesSilent) {
  follow_ = false;
  run(0.1, false);
  run(1.2, true);
  EXPECT_EQ(core_.status().fault, Fault::CONTROLLER_NOT_ARMING);
  beat(false);
  beat(false, true, true);
  follow_ = true;
  arm();
  const double quiet_since = now_;
  while (core_.status().state == BridgeState::ARMED && now_ < quiet_since + 2.0) {
    beat(true);
    now_ = core_.nextFrameTime();
    core_.tick(now_);  // no new status
    core_.onSent(true, now_);
  }
  EXPECT_EQ(core_.status().fault, Fault::TELEMETRY_LOST);
  EXPECT_NEAR(now_ - quiet_since, 1.0, 0.05);
}

TEST_F(Core, MotorsThatDoNotObeyLatch) {
  arm();
  controller_.motor_max = 1400;
  const double start = now_;
  while (core_.status().state == BridgeState::ARMED && now_ < start + 2.0) {
    controller_.motor_time = now_;
    beat(true);
    tick();
  }
  EXPECT_EQ(core_.status().fault, Fault::MOTORS_DISAGREE);
}

TEST_F(Core, ShutdownSendsSafeFramesLongEnoughAndCannotBeReset) {
  arm();
  ASSERT_EQ(core_.onPulse(pulse(1, 1.0, 1.0), now_), Refusal::NONE);
  run(0.1, true);
  core_.requestShutdown(now_);
  const double start = now_;
  int frames = 0;
  while (!core_.shutdownDone(now_)) {
    beat(false, true, frames % 2 == 0);
    tick();
    ++frames;
    ASSERT_TRUE(safe());
  }
  EXPECT_GE(now_ - start, 0.2);
  EXPECT_GE(frames, 10);
  EXPECT_EQ(core_.status().fault, Fault::SHUTDOWN);
}

TEST_F(Core, SecondOperatorNeitherHoldsNorTakesTheDeadman) {
  arm();
  const double last = now_;
  while (core_.status().state == BridgeState::ARMED && now_ < last + 0.5) {
    beat(false, true, false, 99);
    EXPECT_NE(beat(true, true, false, 99), Refusal::NONE);
    tick();
  }
  EXPECT_EQ(core_.status().fault, Fault::HEARTBEAT_LOST);
}

TEST_F(Core, ManySendersCannotPushOutTheOperator) {
  arm();
  for (std::int64_t id = 1000; id < 1100; ++id) {
    beat(false, true, false, id);
    beat(true);
    tick();
  }
  EXPECT_EQ(core_.status().state, BridgeState::ARMED);
}

}  // namespace
}  // namespace snapwing::link
