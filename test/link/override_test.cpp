/// Mixed control, and MSP override: the pilot's receiver leads, the bridge has the masked channels while the pilot's
/// switch is held. Core alone, stand-in alone, and both together.
#include <gtest/gtest.h>

#include <cmath>

#include "link/loop_simulation.h"

namespace snapwing::link {
namespace {

using test::Simulation;

constexpr unsigned THROTTLE_AND_PITCH = 1U << THROTTLE | 1U << PITCH;
constexpr std::size_t OVERRIDE_SWITCH = 5;
constexpr int IDLE_OUTPUT = 1070;  ///< [us]
constexpr double SETTLED = 0.04;   ///< [s] a frame of the pilot's and the motors' ramp

Channels sticks(int throttle, bool armed, bool override_switch) {
  Channels channels = safeChannels();
  channels.us[THROTTLE] = static_cast<std::uint16_t>(throttle);
  channels.us[AUX1] = armed ? CHANNEL_HIGH : CHANNEL_LOW;
  channels.us[OVERRIDE_SWITCH] = override_switch ? CHANNEL_HIGH : CHANNEL_LOW;
  return channels;
}

/// What MSP_RC shows: roll, pitch, yaw, throttle, AUX.
int seenPitch(const Simulation& s) { return s.fc.seenChannels(s.now).us[PITCH]; }
int seenThrottle(const Simulation& s) { return s.fc.seenChannels(s.now).us[3]; }

BridgeSettings mixedSettings(bool pilot_override) {
  BridgeSettings settings;
  settings.max_pitch = 0.5;
  settings.pilot_override = pilot_override;
  return settings;
}

TEST(Mixed, PitchReachesTheControllerDuringThePulseOnly) {
  Simulation s(Simulation::quickStandin(), mixedSettings(false));
  s.arm();
  EXPECT_EQ(seenPitch(s), CHANNEL_CENTRE);
  s.command(0.5, 0.2, -0.3);
  ASSERT_TRUE(s.runUntil(0.08, [&] { return s.fc.motorMicroseconds() == 1509; }));
  EXPECT_EQ(seenPitch(s), 1350);
  EXPECT_EQ(seenThrottle(s), 1500);
  const double start = s.now;
  bool apart = false;
  ASSERT_TRUE(s.runUntil(0.5, [&] {
    apart |= (seenPitch(s) != CHANNEL_CENTRE) != (seenThrottle(s) != CHANNEL_LOW);
    return s.fc.motorMicroseconds() == IDLE_OUTPUT;
  }));
  EXPECT_NEAR(s.now - start, 0.2, 0.0125);
  EXPECT_FALSE(apart) << "pitch and throttle begin and end with the same frame";
  s.run(0.15);
  s.command(0.5, 0.1);
  ASSERT_TRUE(s.runUntil(0.2, [&] { return s.fc.motorMicroseconds() == 1509; }));
  EXPECT_EQ(seenPitch(s), CHANNEL_CENTRE) << "not carried into the next pulse";
}

TEST(Mixed, CentredByAbortAndByALostOperator) {
  for (const bool abort : {true, false}) {
    Simulation s(Simulation::quickStandin(), mixedSettings(false));
    s.arm();
    s.command(1.0, 1.0, 0.5);
    ASSERT_TRUE(s.runUntil(0.05, [&] { return seenPitch(s) == 1750; }));
    if (abort) {
      s.deadman = false;
    } else {
      s.operator_runs = false;
    }
    ASSERT_TRUE(s.runUntil(0.3, [&] { return s.fc.motorMicroseconds() <= IDLE_OUTPUT; }));
    EXPECT_EQ(seenPitch(s), CHANNEL_CENTRE);
  }
}

TEST(Mixed, RefusedBeyondItsBoundAndWhenNotAllowed) {
  for (const double pitch : {0.51, -0.6, 1e300, std::nan("")}) {
    Simulation s(Simulation::quickStandin(), mixedSettings(false));
    s.arm();
    s.command(0.5, 0.1, pitch);
    s.run(0.1);
    EXPECT_EQ(s.bridge->core().status().last_refusal, Refusal::BAD_VALUE) << pitch;
    EXPECT_EQ(seenThrottle(s), CHANNEL_LOW);
  }
  Simulation s;
  s.arm();
  s.command(0.5, 0.1, 0.1);
  s.run(0.1);
  EXPECT_EQ(s.bridge->core().status().last_refusal, Refusal::MIXED_NOT_ALLOWED);
}

/// Stand-in alone: a pilot's stream at 100 Hz, frames of the computer when asked for.
class Override : public ::testing::Test {
 protected:
  static standin::StandinSettings settings(double hold = 1e18) {
    standin::StandinSettings settings = Simulation::quickStandin();
    settings.override_mask = THROTTLE_AND_PITCH;
    settings.override_hold = hold;
    return settings;
  }
  void fly(standin::StandinController& fc, double seconds, const Channels& pilot) {
    for (const double end = now_ + seconds; now_ < end; now_ += 0.01) fc.onPilotFrame(pilot, now_);
  }
  void arm(standin::StandinController& fc) {
    fly(fc, 1.0, sticks(1000, false, false));
    fly(fc, 0.2, sticks(1000, true, false));
    ASSERT_TRUE(fc.armed());
  }
  static Channels computer(int throttle) { return sticks(throttle, false, false); }
  double now_ = 0;
};

TEST_F(Override, OnlyMaskedChannelsAndOnlyWhileTheSwitchIsHeld) {
  standin::StandinController fc(settings(), now_);
  arm(fc);
  Channels from_computer = computer(1700);
  from_computer.us[ROLL] = 1900;
  from_computer.us[PITCH] = 1300;
  fc.onFrame(from_computer, now_);
  fly(fc, 0.1, sticks(1300, true, false));
  EXPECT_EQ(fc.motorMicroseconds(), 1314) << "the pilot's throttle";
  fly(fc, SETTLED, sticks(1300, true, true));
  EXPECT_TRUE(fc.overrideActive());
  EXPECT_EQ(fc.motorMicroseconds(), 1706) << "the computer's";
  EXPECT_EQ(fc.seenChannels(now_).us[PITCH], 1300);
  EXPECT_EQ(fc.seenChannels(now_).us[ROLL], CHANNEL_CENTRE) << "not masked";
  EXPECT_TRUE(fc.armed()) << "the computer's low AUX1 is not masked";
  fly(fc, SETTLED, sticks(1300, true, false));
  EXPECT_EQ(fc.motorMicroseconds(), 1314) << "sticks take control back with the next frame";
  fly(fc, 0.06, sticks(1300, false, true));  // five frames
  EXPECT_FALSE(fc.armed()) << "the pilot's arm switch works under override";
}

/// The danger that docs/safety.md names: nothing but the pilot's switch ends the last value of a dead computer.
TEST_F(Override, DeadComputersLastValueStaysUntilThePilotLetsGo) {
  standin::StandinController fc(settings(), now_);
  arm(fc);
  fc.onFrame(computer(1700), now_);
  fly(fc, 10.0, sticks(1000, true, true));
  EXPECT_EQ(fc.motorMicroseconds(), 1706);
  EXPECT_FALSE(fc.failsafe());
  fly(fc, SETTLED, sticks(1000, true, false));
  EXPECT_EQ(fc.motorMicroseconds(), IDLE_OUTPUT);
}

TEST_F(Override, ReleasesThatAgeTheValueGiveTheSticksBack) {
  standin::StandinController fc(settings(0.3), now_);
  arm(fc);
  fc.onFrame(computer(1700), now_);
  const double sent = now_;
  fly(fc, SETTLED, sticks(1000, true, true));
  EXPECT_EQ(fc.motorMicroseconds(), 1706);
  while (fc.motorMicroseconds() != IDLE_OUTPUT && now_ < 10.0) fly(fc, 0.01, sticks(1000, true, true));
  // Held up to the pilot's next frame behind .3 s, then the ramp of 21 ms, seen with a frame and told by the next one.
  EXPECT_GE(now_ - sent, 0.3 + 0.021);
  EXPECT_LE(now_ - sent, 0.3 + 0.021 + 3 * 0.01);
}

TEST_F(Override, LostReceiverIsNotKeptAliveByTheComputer) {
  standin::StandinController fc(settings(), now_);
  arm(fc);
  fly(fc, 0.1, sticks(1000, true, true));
  const double last = now_;
  for (; now_ < last + 1.6; now_ += 0.01) {
    fc.onFrame(computer(1700), now_);
    if (now_ - last > 0.3) {
      ASSERT_LE(fc.motorMicroseconds(), IDLE_OUTPUT);
    }
  }
  EXPECT_TRUE(fc.failsafe());
}

TEST_F(Override, BeforeTheFirstFrameOfTheComputerThrottleIsLow) {
  standin::StandinController fc(settings(), now_);
  arm(fc);
  fly(fc, 0.1, sticks(1600, true, true));
  EXPECT_EQ(fc.motorMicroseconds(), IDLE_OUTPUT) << "why the bridge streams before the switch is thrown";
}

/// Bridge, stand-in and pilot together.
class PilotAndBridge : public ::testing::Test {
 protected:
  static standin::StandinSettings standin(unsigned mask) {
    standin::StandinSettings settings = Simulation::quickStandin();
    settings.override_mask = mask;
    return settings;
  }
  explicit PilotAndBridge(unsigned mask = THROTTLE_AND_PITCH) : s_(standin(mask), mixedSettings(true)) {}

  void takeOff() {
    s_.pilot = sticks(1000, false, false);
    s_.run(1.5);
    s_.pilot = sticks(1000, true, false);
    s_.run(0.2);
    ASSERT_TRUE(s_.fc.armed());
    s_.pilot = sticks(1300, true, true);
    s_.run(0.5);
    s_.arm_switch = true;
    ASSERT_TRUE(s_.runUntil(1.0, [&] { return state() == BridgeState::ARMED; }));
    s_.run(0.3);
  }
  BridgeState state() const { return s_.bridge->core().status().state; }

  Simulation s_;
};

TEST_F(PilotAndBridge, PulseUnderOverride) {
  takeOff();
  s_.command(0.8, 0.2, 0.4);
  ASSERT_TRUE(s_.runUntil(0.05, [&] { return seenThrottle(s_) == 1800; }));
  EXPECT_EQ(seenPitch(s_), 1700);
  s_.run(0.3);
  EXPECT_EQ(seenThrottle(s_), CHANNEL_LOW);
  EXPECT_EQ(state(), BridgeState::ARMED);
  EXPECT_TRUE(s_.fc.armed()) << "the bridge's AUX1 low does not disarm the pilot's aircraft";
}

TEST_F(PilotAndBridge, NothingWithoutThePilot) {
  s_.pilot = sticks(1000, false, true);
  s_.run(1.5);
  s_.arm_switch = true;
  s_.run(0.3);
  EXPECT_EQ(state(), BridgeState::IDLE);
  EXPECT_EQ(s_.bridge->core().status().last_refusal, Refusal::PILOT_NOT_READY);
}

/// The sticks are back within two frames of the pilot's, and the pulse does not come again with the switch.
TEST_F(PilotAndBridge, LettingGoTakesControlBackForGood) {
  takeOff();
  s_.command(1.0, 1.0, 0.4);
  s_.run(0.2);
  ASSERT_EQ(seenThrottle(s_), CHANNEL_HIGH);
  s_.pilot = sticks(1300, true, false);
  s_.run(0.02);
  EXPECT_EQ(seenThrottle(s_), 1300);
  EXPECT_EQ(seenPitch(s_), CHANNEL_CENTRE);
  ASSERT_TRUE(s_.runUntil(0.25, [&] { return state() == BridgeState::FAULT; })) << "read back 12 times a second";
  EXPECT_EQ(s_.bridge->core().status().fault, Fault::PILOT_TOOK_OVER);
  s_.run(0.02);  // the controller's turn for the first safe frame
  s_.pilot = sticks(1300, true, true);
  s_.highest_motor = 0;
  s_.run(2.0, [&] { EXPECT_LE(seenThrottle(s_), 1300); });
  EXPECT_LE(s_.highest_motor, 1314);
}

TEST_F(PilotAndBridge, PilotsArmSwitchLatchesTheBridge) {
  takeOff();
  s_.command(1.0, 1.0);
  s_.run(0.1);
  s_.pilot = sticks(1300, false, true);
  s_.run(0.06);  // five frames of the pilot's
  EXPECT_EQ(s_.fc.motorMicroseconds(), 1000);
  ASSERT_TRUE(s_.runUntil(0.25, [&] { return state() == BridgeState::FAULT; }));
  EXPECT_EQ(s_.bridge->core().status().fault, Fault::CONTROLLER_DISARMED);
}

/// A reset needs the pilot's hand off the override switch, not his landing; the next arming needs both switches anew.
TEST_F(PilotAndBridge, ResetWhileThePilotFliesButHoldsNoSwitch) {
  takeOff();
  s_.pilot = sticks(1300, true, false);
  ASSERT_TRUE(s_.runUntil(0.25, [&] { return state() == BridgeState::FAULT; }));
  s_.arm_switch = false;
  s_.pilot = sticks(1300, true, true);
  s_.run(0.3);
  s_.reset = true;
  s_.run(0.1);
  EXPECT_EQ(state(), BridgeState::FAULT) << "his switch is held";
  EXPECT_EQ(s_.bridge->core().status().last_refusal, Refusal::RESET_WHILE_ARMED);
  s_.reset = false;
  s_.pilot = sticks(1300, true, false);
  s_.run(0.3);
  s_.reset = true;
  s_.run(0.1);
  EXPECT_EQ(state(), BridgeState::IDLE);
  EXPECT_TRUE(s_.fc.armed()) << "he flies on";
  s_.reset = false;
  s_.pilot = sticks(1300, true, true);
  s_.run(0.5);
  EXPECT_EQ(state(), BridgeState::IDLE) << "nothing comes back by itself";
  s_.arm_switch = true;
  s_.run(0.3);
  EXPECT_EQ(state(), BridgeState::ARMED);
}

class WithoutOverrideBox : public PilotAndBridge {
 protected:
  WithoutOverrideBox() : PilotAndBridge(0) {}
};

TEST_F(WithoutOverrideBox, IsRefused) {
  s_.run(1.5);
  EXPECT_FALSE(s_.bridge->core().status().controller.known);
  EXPECT_EQ(s_.bridge->watch().failedCheck(), Check::OVERRIDE_BOX);
}

}  // namespace
}  // namespace snapwing::link
