#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>
#include <utility>
#include <vector>

#include "snapwing/common/error.h"
#include "snapwing/planning/switch_protocol.h"

namespace snapwing::planning {
namespace {

using vehicle::Mode;
using Bridge = SwitchView::Bridge;
using Outcome = SwitchOutcome;
using State = SwitchState;

/// Everything as it should be before a switch F -> Q.
SwitchView goodView() {
  SwitchView view;
  view.now = 100.0;
  view.link_age = view.mode_age = view.reading_age = 0.01;
  view.bridge = Bridge::ARMED;
  view.controller_connected = view.controller_armed = true;
  view.pulse_id = 3;
  view.mode = Mode::FIXED_WING;
  return view;
}

class SwitchTest : public ::testing::Test {
 protected:
  static constexpr double LENGTH = 0.2;
  static constexpr std::uint32_t ID = 40;

  SwitchAction after(double seconds) {
    view_.now += seconds;
    return protocol_.step(view_);
  }
  void send() { ASSERT_EQ(after(0.0), SwitchAction::SEND); }
  void run() {
    send();
    view_.bridge = Bridge::PULSE;
    view_.pulse_id = ID;
    ASSERT_EQ(after(0.05), SwitchAction::WAIT);
    ASSERT_EQ(protocol_.state(), State::RUNNING);
  }
  void settle() {
    run();
    view_.bridge = Bridge::ARMED;
    ASSERT_EQ(after(0.2), SwitchAction::WAIT);
    ASSERT_EQ(protocol_.state(), State::SETTLING);
  }
  void expectEnd(Outcome outcome, const std::string& words) {
    EXPECT_EQ(protocol_.state(), State::DONE);
    EXPECT_EQ(protocol_.outcome(), outcome);
    EXPECT_NE(protocol_.message().find(words), std::string::npos) << protocol_.message();
    EXPECT_EQ(std::isfinite(protocol_.switchSeconds()), outcome == Outcome::SUCCEEDED);
    EXPECT_EQ(after(1.0), SwitchAction::FINISH);
    EXPECT_EQ(protocol_.outcome(), outcome);
  }

  SwitchSettings settings_;
  SwitchView view_ = goodView();
  SwitchProtocol protocol_{settings_, Mode::QUADROTOR, LENGTH, ID};
};

TEST(SwitchTable, EachPairOfStateAndEventHasOneRowAndEveryStateIsLeft) {
  std::set<std::pair<State, SwitchEvent>> seen;
  std::set<State> left;
  for (const SwitchRow& row : SwitchProtocol::table()) {
    EXPECT_TRUE(seen.insert({row.from, row.event}).second);
    EXPECT_EQ(row.to == State::DONE, row.outcome != Outcome::NONE);
    left.insert(row.from);
  }
  EXPECT_EQ(left, (std::set<State>{State::READY, State::SENT, State::RUNNING, State::SETTLING}));
}

TEST_F(SwitchTest, SwitchesAndTellsHowLongItTook) {
  settle();
  view_.mode = Mode::QUADROTOR;
  EXPECT_EQ(after(0.1), SwitchAction::WAIT);
  EXPECT_EQ(after(0.2), SwitchAction::WAIT);
  EXPECT_EQ(after(0.11), SwitchAction::FINISH);
  EXPECT_NEAR(protocol_.switchSeconds(), 0.35, 1e-9);
  expectEnd(Outcome::SUCCEEDED, "switched");
  EXPECT_EQ(protocol_.id(), ID);
}

TEST_F(SwitchTest, NamesEverythingThatIsMissing) {
  const SwitchView nothing = [] {
    SwitchView view;
    view.link_trouble = view.mode_trouble = "never came";
    return view;
  }();
  const auto list = SwitchProtocol::missing(settings_, nothing, Mode::QUADROTOR);
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[0], "the link status never came: is the radio bridge running?");
  EXPECT_EQ(list[1], "the mode estimate never came: is wing_state_node running?");

  view_.controller_armed = false;
  view_.controller_failsafe = true;
  view_.bridge = Bridge::IDLE;
  view_.mode = Mode::UNKNOWN;
  view_.mode_reason = "no IMU reading came";
  EXPECT_EQ(after(0.0), SwitchAction::FINISH);
  expectEnd(Outcome::NOT_READY,
            "the flight controller is in failsafe; the flight controller is not armed; the radio bridge is not armed; "
            "the mode is not known: no IMU reading came");
}

TEST_F(SwitchTest, EachSingleLackRefuses) {
  const std::vector<std::pair<std::string, std::function<void(SwitchView&)>>> lacks = {
      {"the link status stopped 2.0 s ago",
       [](SwitchView& v) { v.link_age = 2.0, v.link_trouble = "stopped 2.0 s ago"; }},
      {"no vehicle is connected", [](SwitchView& v) { v.controller_connected = v.controller_armed = false; }},
      {"latched a fault: deadman", [](SwitchView& v) { v.bridge = Bridge::FAULT, v.bridge_fault = "deadman"; }},
      {"failsafe", [](SwitchView& v) { v.controller_failsafe = true; }},
      {"the flight controller is not armed", [](SwitchView& v) { v.controller_armed = false; }},
      {"the radio bridge is not armed", [](SwitchView& v) { v.bridge = Bridge::IDLE; }},
      {"still sending a pulse", [](SwitchView& v) { v.bridge = Bridge::PULSE; }},
      {"the mode estimate stopped", [](SwitchView& v) { v.mode_age = 2.0, v.mode_trouble = "stopped 2.0 s ago"; }},
      {"the mode is not known", [](SwitchView& v) { v.mode = Mode::UNKNOWN; }},
      {"no fresh IMU reading", [](SwitchView& v) { v.reading_age = 2.0; }},
      {"no fresh IMU reading", [](SwitchView& v) { v.reading_age = NAN; }},
      {"already in the target mode", [](SwitchView& v) { v.mode = Mode::QUADROTOR; }},
  };
  EXPECT_TRUE(SwitchProtocol::missing(settings_, view_, Mode::QUADROTOR).empty());
  for (const auto& [words, spoil] : lacks) {
    SwitchView view = goodView();
    spoil(view);
    const auto list = SwitchProtocol::missing(settings_, view, Mode::QUADROTOR);
    ASSERT_EQ(list.size(), 1u) << words << ": " << SwitchProtocol::missingText(list);
    EXPECT_NE(list[0].find(words), std::string::npos) << list[0];
  }
}

TEST_F(SwitchTest, NeverSucceedsWithoutReadings) {
  settle();
  view_.mode = Mode::QUADROTOR;  // the estimate goes on saying Q, but no reading stands behind it
  view_.reading_age = 1.0;
  for (int i = 0; i < 79; ++i) EXPECT_EQ(after(0.05), SwitchAction::WAIT);
  EXPECT_EQ(after(0.1), SwitchAction::FINISH);
  expectEnd(Outcome::NOT_SETTLED, "did not become known");
}

TEST_F(SwitchTest, AStayIsCountedAnewAfterADoubt) {
  settle();
  view_.mode = Mode::QUADROTOR;
  EXPECT_EQ(after(0.1), SwitchAction::WAIT);
  view_.mode = Mode::UNKNOWN;
  EXPECT_EQ(after(0.25), SwitchAction::WAIT);
  view_.mode = Mode::QUADROTOR;
  EXPECT_EQ(after(0.1), SwitchAction::WAIT);
  EXPECT_EQ(after(0.29), SwitchAction::WAIT);
  EXPECT_EQ(after(0.02), SwitchAction::FINISH);
  EXPECT_NEAR(protocol_.switchSeconds(), 0.70, 1e-9);
}

TEST_F(SwitchTest, AStayInTheOldModeCountsOnlyAtTheEnd) {
  settle();
  EXPECT_EQ(after(3.9), SwitchAction::WAIT);
  EXPECT_EQ(after(0.2), SwitchAction::FINISH);
  expectEnd(Outcome::WRONG_MODE, "settled in the mode that it started from");
}

TEST_F(SwitchTest, SendsAgainWhatNobodyTook) {
  send();
  view_.link_age = 0.4;  // a status from before the command's end says nothing
  EXPECT_EQ(after(0.51), SwitchAction::WAIT);
  EXPECT_EQ(protocol_.state(), State::SENT);
  view_.link_age = 0.01;
  EXPECT_EQ(after(0.01), SwitchAction::WAIT);
  EXPECT_EQ(protocol_.state(), State::READY);
  EXPECT_EQ(after(0.01), SwitchAction::SEND);
  EXPECT_EQ(protocol_.id(), ID + 1);
  EXPECT_EQ(after(0.6), SwitchAction::FINISH);
  expectEnd(Outcome::LINK_LOST, "did not take the pulse");
  EXPECT_EQ(protocol_.attempts(), 2);
}

TEST_F(SwitchTest, DoesNotSendAgainWhenSomethingIsMissingByThen) {
  send();
  EXPECT_EQ(after(0.51), SwitchAction::WAIT);
  view_.mode = Mode::UNKNOWN;
  EXPECT_EQ(after(0.01), SwitchAction::FINISH);
  expectEnd(Outcome::NOT_READY, "the mode is not known");
}

/// The clock was set back, or simulated time began anew, while the bridge went on.
TEST_F(SwitchTest, AnIdOfTheBridgesPastIsNotUsedAgain) {
  for (const std::uint32_t seen : {ID, ID + 1000}) {
    SwitchProtocol protocol(settings_, Mode::QUADROTOR, LENGTH, ID);
    view_.pulse_id = seen;
    ASSERT_EQ(protocol.step(view_), SwitchAction::SEND);
    EXPECT_EQ(protocol.id(), seen + 1);
    view_.now += 0.02;
    EXPECT_EQ(protocol.step(view_), SwitchAction::WAIT);
    EXPECT_EQ(protocol.state(), State::SENT) << "the old pulse is taken for the new one";
  }
}

TEST_F(SwitchTest, ARefusalIsTheEnd) {
  send();
  ++view_.refused;
  view_.last_refusal = "stale command";
  EXPECT_EQ(after(0.02), SwitchAction::FINISH);
  expectEnd(Outcome::NOT_READY, "the link refused the pulse: stale command");
}

TEST_F(SwitchTest, ALinkThatFailsIsTheEndInEachState) {
  for (const State state : {State::SENT, State::RUNNING, State::SETTLING}) {
    view_ = goodView();
    protocol_ = SwitchProtocol(settings_, Mode::QUADROTOR, LENGTH, ID);
    if (state == State::SENT) send();
    if (state == State::RUNNING) run();
    if (state == State::SETTLING) settle();
    view_.link_age = 0.6;
    view_.link_trouble = "stopped 0.6 s ago";
    EXPECT_EQ(after(0.02), SwitchAction::FINISH);
    expectEnd(Outcome::LINK_LOST, "stopped 0.6 s ago");
  }
}

TEST_F(SwitchTest, CanBeWithdrawnInEachState) {
  for (const State state : {State::READY, State::SENT, State::RUNNING, State::SETTLING}) {
    view_ = goodView();
    protocol_ = SwitchProtocol(settings_, Mode::QUADROTOR, LENGTH, ID);
    if (state == State::SENT) send();
    if (state == State::RUNNING) run();
    if (state == State::SETTLING) settle();
    view_.stop_asked = true;
    EXPECT_EQ(after(0.02), SwitchAction::FINISH);
    expectEnd(Outcome::PREEMPTED, "preempted");
  }
}

TEST_F(SwitchTest, APulseThatDoesNotEndIsAFault) {
  run();
  EXPECT_EQ(after(0.4), SwitchAction::WAIT);
  EXPECT_EQ(after(0.4), SwitchAction::FINISH);
  expectEnd(Outcome::LINK_LOST, "does not end");
}

TEST(SwitchProtocol, RefusesBadSettings) {
  SwitchSettings settings;
  EXPECT_THROW(SwitchProtocol(settings, Mode::UNKNOWN, 0.1, 1), common::Error);
  EXPECT_THROW(SwitchProtocol(settings, Mode::QUADROTOR, NAN, 1), common::Error);
  settings.attempts = 0;
  EXPECT_THROW(SwitchProtocol(settings, Mode::QUADROTOR, 0.1, 1), common::Error);
  settings = {};
  settings.command_life = 1.0;
  EXPECT_THROW(SwitchProtocol(settings, Mode::QUADROTOR, 0.1, 1), common::Error);
}

}  // namespace
}  // namespace snapwing::planning
