/// The arming protocol, row by row of its table, on a fake clock and a fake bridge.
#include "snapwing/link/arming_protocol.h"

#include <gtest/gtest.h>

namespace snapwing::link {
namespace {

using Request = ArmingProtocol::Request;
using State = ArmingProtocol::State;

class Arming : public ::testing::Test {
 protected:
  Arming() {
    view_.alive = view_.deadman_held = true;
    view_.listened = 10.0;
    view_.status.state = BridgeState::IDLE;
    view_.status.number = 100;
  }
  /// Lets time pass; the bridge's status comes every 20 ms if it is alive.
  void run(double seconds) {
    for (const double end = now_ + seconds; now_ < end - 1e-9;) {
      now_ += 0.002;
      if (view_.alive && ++turns_ % 10 == 0) ++view_.status.number;
      protocol_.step(view_, now_);
    }
  }
  std::int64_t ask(Request request) { return protocol_.ask(request, view_, now_); }
  bool over(std::int64_t ticket) { return protocol_.answer(ticket, answer_); }
  void bridge(BridgeState state, bool controller_armed = false) {
    view_.status.state = state;
    view_.status.controller.armed = controller_armed;
    run(0.022);
  }
  void refuseByBridge(Refusal refusal) {
    ++view_.status.commands_refused;
    view_.status.last_refusal = refusal;
    run(0.022);
  }
  void arm() {
    const std::int64_t ticket = ask(Request::ARM);
    run(0.07);
    bridge(BridgeState::ARMED);
    bridge(BridgeState::ARMED, true);
    ASSERT_TRUE(over(ticket));
    ASSERT_TRUE(answer_.success) << answer_.message;
    ASSERT_EQ(protocol_.state(), State::ON);
  }
  bool says(const char* words) const { return answer_.message.find(words) != std::string::npos; }

  double now_ = 50.0;
  int turns_ = 0;
  LinkView view_;
  ArmingProtocol protocol_;
  ArmingAnswer answer_;
};

TEST_F(Arming, ShowsTheSwitchOffThenOnAndWaitsForBridgeAndController) {
  EXPECT_FALSE(protocol_.armSwitch());
  const std::int64_t ticket = ask(Request::ARM);
  run(0.058);
  EXPECT_EQ(protocol_.state(), State::CYCLE);
  EXPECT_FALSE(protocol_.armSwitch());
  run(0.004);
  EXPECT_EQ(protocol_.state(), State::ASK);
  EXPECT_TRUE(protocol_.armSwitch());
  bridge(BridgeState::ARMED);
  EXPECT_EQ(protocol_.state(), State::CONFIRM);
  EXPECT_FALSE(over(ticket));
  bridge(BridgeState::ARMED, true);
  EXPECT_EQ(protocol_.state(), State::ON);
  ASSERT_TRUE(over(ticket));
  EXPECT_TRUE(answer_.success);
  run(5.0);
  bridge(BridgeState::PULSE, true);
  EXPECT_TRUE(protocol_.armSwitch());
  bridge(BridgeState::FAULT);
  EXPECT_EQ(protocol_.state(), State::OFF);
  EXPECT_FALSE(protocol_.armSwitch()) << "a switch left on must not look like a wish to arm again";
}

TEST_F(Arming, ArmedAlreadyIsAnsweredAtOnce) {
  arm();
  const std::int64_t ticket = ask(Request::ARM);
  ASSERT_TRUE(over(ticket));
  EXPECT_TRUE(answer_.success);
  EXPECT_TRUE(protocol_.armSwitch());
}

TEST_F(Arming, NamesWhatIsMissing) {
  view_.alive = false;
  view_.hint = "another vehicle";
  std::int64_t ticket = ask(Request::ARM);
  run(0.7);
  ASSERT_TRUE(over(ticket));
  EXPECT_TRUE(!answer_.success && says("no radio bridge") && says("another vehicle")) << answer_.message;
  view_.alive = true;
  view_.deadman_held = false;
  ticket = ask(Request::ARM);
  run(0.7);
  ASSERT_TRUE(over(ticket));
  EXPECT_TRUE(!answer_.success && says("deadman")) << answer_.message;
  view_.deadman_held = true;
  ticket = ask(Request::ARM);
  run(0.7);
  ASSERT_TRUE(over(ticket));
  EXPECT_TRUE(!answer_.success && says("does not answer")) << answer_.message;
  ticket = ask(Request::ARM);
  run(0.07);
  refuseByBridge(Refusal::CONTROLLER_FAILSAFE);
  ASSERT_TRUE(over(ticket));
  EXPECT_TRUE(!answer_.success && says("failsafe")) << answer_.message;
  EXPECT_FALSE(protocol_.armSwitch());
}

TEST_F(Arming, ListensForOtherBridgesFirst) {
  view_.listened = 0.0;
  const std::int64_t ticket = ask(Request::ARM);
  run(0.3);
  EXPECT_EQ(protocol_.state(), State::CYCLE) << "not before it has listened";
  view_.conflict = true;
  run(0.002);
  ASSERT_TRUE(over(ticket));
  EXPECT_TRUE(!answer_.success && says("two radio bridges"));
  view_.listened = 10.0;
  const std::int64_t again = ask(Request::ARM);
  run(0.1);
  EXPECT_TRUE(over(again) && !answer_.success);
  EXPECT_FALSE(protocol_.armSwitch());
}

TEST_F(Arming, ASecondBridgeThatAppearsWhileAskingEndsIt) {
  const std::int64_t ticket = ask(Request::ARM);
  run(0.07);
  ASSERT_TRUE(protocol_.armSwitch());
  view_.conflict = true;
  run(0.002);
  EXPECT_FALSE(protocol_.armSwitch());
  EXPECT_TRUE(over(ticket) && !answer_.success);
}

TEST_F(Arming, AControllerThatDoesNotArmEndsIt) {
  std::int64_t ticket = ask(Request::ARM);
  run(0.07);
  bridge(BridgeState::ARMED);
  run(1.2);
  ASSERT_TRUE(over(ticket));
  EXPECT_TRUE(!answer_.success && says("does not report armed"));
  EXPECT_EQ(protocol_.state(), State::OFF);
  bridge(BridgeState::IDLE);
  ticket = ask(Request::ARM);
  run(0.07);
  bridge(BridgeState::ARMED);
  view_.status.fault = Fault::CONTROLLER_NOT_ARMING;
  bridge(BridgeState::FAULT);
  ASSERT_TRUE(over(ticket));
  EXPECT_TRUE(!answer_.success && says("did not arm")) << answer_.message;
}

TEST_F(Arming, Disarms) {
  arm();
  std::int64_t ticket = ask(Request::DISARM);
  EXPECT_FALSE(protocol_.armSwitch()) << "at once";
  run(0.1);
  EXPECT_FALSE(over(ticket));
  bridge(BridgeState::IDLE);
  EXPECT_TRUE(over(ticket) && answer_.success);
  view_.alive = false;
  ticket = ask(Request::DISARM);
  run(0.61);
  EXPECT_TRUE(over(ticket) && !answer_.success && says("does not confirm"));
}

TEST_F(Arming, ResetsWithTheSwitchShownOffBefore) {
  view_.status.fault = Fault::ABORTED;
  bridge(BridgeState::FAULT);
  std::int64_t ticket = ask(Request::RESET);
  run(0.058);
  EXPECT_FALSE(protocol_.resetFlag());
  run(0.004);
  EXPECT_TRUE(protocol_.resetFlag());
  EXPECT_FALSE(protocol_.armSwitch());
  bridge(BridgeState::IDLE);
  EXPECT_TRUE(over(ticket) && answer_.success);
  EXPECT_FALSE(protocol_.resetFlag());
  bridge(BridgeState::FAULT);
  ticket = ask(Request::RESET);
  run(0.07);
  refuseByBridge(Refusal::RESET_WHILE_ARMED);
  EXPECT_TRUE(over(ticket) && !answer_.success && says("armed"));
  ticket = ask(Request::RESET);
  run(0.7);
  EXPECT_TRUE(over(ticket) && !answer_.success && says("aborted")) << answer_.message;
}

TEST_F(Arming, AbortEndsEverythingAndKeepsItsPlace) {
  for (const double into : {0.0, 0.03, 0.07, 0.1}) {
    bridge(BridgeState::IDLE);
    const std::int64_t arming = ask(Request::ARM);
    run(into);
    const std::int64_t abort = ask(Request::ABORT);
    EXPECT_FALSE(protocol_.armSwitch());
    EXPECT_FALSE(protocol_.deadmanAllowed());
    EXPECT_TRUE(over(arming) && !answer_.success && says("superseded"));
    const std::int64_t late = ask(Request::ARM);
    EXPECT_TRUE(over(late) && !answer_.success && says("abort"));
    const std::int64_t reset = ask(Request::RESET);
    EXPECT_TRUE(over(reset) && !answer_.success);
    run(0.5);
    EXPECT_EQ(protocol_.state(), State::ABORT) << "until the bridge shows a fault";
    EXPECT_FALSE(over(abort));
    bridge(BridgeState::FAULT);
    EXPECT_TRUE(over(abort) && answer_.success);
    EXPECT_EQ(protocol_.state(), State::OFF);
  }
  view_.alive = false;
  const std::int64_t abort = ask(Request::ABORT);
  run(1.9);
  EXPECT_FALSE(protocol_.deadmanAllowed());
  run(0.2);
  EXPECT_TRUE(over(abort) && !answer_.success && says("does not confirm"));
}

TEST_F(Arming, AFaultOfBeforeDoesNotConfirmAnAbort) {
  bridge(BridgeState::FAULT);
  const std::int64_t abort = ask(Request::ABORT);
  protocol_.step(view_, now_);
  EXPECT_FALSE(over(abort)) << "that status is older than the abort";
  run(0.022);
  EXPECT_TRUE(over(abort) && answer_.success);
}

TEST_F(Arming, ARefusalOfBeforeIsNotTheAnswer) {
  refuseByBridge(Refusal::STALE);
  const std::int64_t ticket = ask(Request::ARM);
  run(0.07);
  run(0.1);
  EXPECT_FALSE(over(ticket));
  EXPECT_TRUE(protocol_.armSwitch());
}

TEST_F(Arming, LostStatusesDoNotEndIt) {
  arm();
  view_.alive = false;
  run(1.0);
  EXPECT_TRUE(protocol_.armSwitch()) << "the bridge's own watch decides";
  view_.alive = true;
  bridge(BridgeState::IDLE);
  EXPECT_FALSE(protocol_.armSwitch());
}

}  // namespace
}  // namespace snapwing::link
