/// The stand-in flight controller against the measured rules, on a fake clock.
#include <gtest/gtest.h>

#include <cmath>

#include "standin_controller.h"

namespace snapwing::link {
namespace {

class Standin : public ::testing::Test {
 protected:
  static constexpr double PERIOD = 0.02;

  explicit Standin(double boot_grace = 5.0) : fc_(settings(boot_grace), 0.0) {}
  static standin::StandinSettings settings(double boot_grace) {
    standin::StandinSettings s;
    s.boot_grace = boot_grace;
    return s;
  }

  static Channels frame(int throttle, int aux1, int count = 8) {
    Channels channels = safeChannels();
    channels.us[THROTTLE] = static_cast<std::uint16_t>(throttle);
    channels.us[AUX1] = static_cast<std::uint16_t>(aux1);
    channels.count = count;
    return channels;
  }
  /// Lets time pass in milliseconds, without frames.
  void silence(double seconds) {
    const double end = now_ + seconds;
    while (now_ < end - 1e-9) fc_.step(now_ += 0.001);
  }
  /// A stream at 50 Hz.
  void stream(double seconds, const Channels& channels) {
    const double end = now_ + seconds;
    while (now_ < end - 1e-9) {
      fc_.onFrame(channels, now_);
      silence(PERIOD);
    }
  }
  void arm() {
    stream(6.0, frame(1000, 1000));
    stream(0.2, frame(1000, 2000));
    ASSERT_TRUE(fc_.armed());
  }

  standin::StandinController fc_;
  double now_ = 0;
};

TEST_F(Standin, FlagsAfterPowerOn) {
  EXPECT_EQ(fc_.armingFlags(), standin::FLAG_RXLOSS | standin::FLAG_BOOTGRACE);
  stream(0.48, frame(1000, 1000));
  EXPECT_TRUE(fc_.armingFlags() & standin::FLAG_RXLOSS);
  stream(0.04, frame(1000, 1000));
  EXPECT_EQ(fc_.armingFlags(), static_cast<std::uint32_t>(standin::FLAG_BOOTGRACE));
  stream(4.5, frame(1000, 1000));
  EXPECT_EQ(fc_.armingFlags(), 0U);
}

/// Measured: 23 ms from AUX1 to idle, a frame of 20 ms and a little.
TEST_F(Standin, ArmsWithTheSecondFrame) {
  stream(6.0, frame(1000, 1000));
  fc_.onFrame(frame(1000, 1700), now_);
  silence(0.0195);
  EXPECT_FALSE(fc_.armed());
  fc_.onFrame(frame(1000, 1700), now_);
  EXPECT_TRUE(fc_.armed());
  EXPECT_EQ(fc_.motorMicroseconds(), 1070);
}

/// Measured: AUX1 low at throttle 1500, motors off after 91 ms; AUX1 and throttle low, idle after 22 ms, off after 88
/// ms.
TEST_F(Standin, SwitchOffDisarmsAfterFourMoreFrames) {
  for (const int throttle : {1500, 1000}) {
    SCOPED_TRACE(throttle);
    stream(6.0, frame(1000, 1000));
    stream(0.2, frame(1000, 2000));
    stream(0.2, frame(1500, 2000));
    const double begin = now_;
    double idle = 0, off = 0;
    for (int k = 0; k < 10; ++k) {
      fc_.onFrame(frame(throttle, 1000), now_);
      for (int i = 0; i < 20; ++i) {
        silence(0.001);
        if (idle == 0 && fc_.motorMicroseconds() <= 1070) idle = now_ - begin;
        if (off == 0 && fc_.motorMicroseconds() == 1000) off = now_ - begin;
      }
    }
    EXPECT_NEAR(off, 0.085, 0.007);
    EXPECT_NEAR(idle, throttle == 1500 ? off : 0.021, 0.0021);
  }
}

TEST_F(Standin, SwitchBelowThresholdDoesNotArm) {
  stream(6.0, frame(1000, 1000));
  stream(0.5, frame(1000, 1699));
  EXPECT_FALSE(fc_.armed());
}

TEST_F(Standin, SwitchOnAtFirstFrameMustBeOffOnce) {
  stream(7.0, frame(1000, 2000));
  EXPECT_FALSE(fc_.armed());
  EXPECT_TRUE(fc_.armingFlags() & standin::FLAG_NOT_DISARMED);
  stream(0.1, frame(1000, 1000));
  EXPECT_EQ(fc_.armingFlags(), 0U);
  stream(0.1, frame(1000, 2000));
  EXPECT_TRUE(fc_.armed());
}

TEST_F(Standin, ThrottleHighWhenSwitched) {
  stream(6.0, frame(1000, 1000));
  stream(0.2, frame(1300, 2000));
  EXPECT_FALSE(fc_.armed());
  EXPECT_EQ(fc_.armingFlags(), standin::FLAG_THROTTLE | standin::FLAG_ARMSWITCH);
  stream(0.5, frame(1000, 2000));
  EXPECT_FALSE(fc_.armed()) << "lowering the throttle alone does not arm";
  EXPECT_EQ(fc_.armingFlags(), static_cast<std::uint32_t>(standin::FLAG_ARMSWITCH));
  stream(0.1, frame(1000, 1000));
  stream(0.1, frame(1000, 2000));
  EXPECT_TRUE(fc_.armed());
}

TEST_F(Standin, BootGraceAndSwitch) {
  stream(1.0, frame(1000, 1000));
  stream(5.0, frame(1000, 2000));  // switched during boot grace
  EXPECT_FALSE(fc_.armed());
  EXPECT_TRUE(fc_.armingFlags() & standin::FLAG_ARMSWITCH);
}

TEST_F(Standin, ThrottleScalingAsMeasured) {
  arm();
  const int measured[][2] = {{1000, 1070}, {1100, 1118}, {1300, 1314}, {1500, 1509}, {1700, 1706}, {2000, 1999}};
  for (const auto& pair : measured) {
    stream(0.04, frame(pair[0], 2000));
    EXPECT_EQ(fc_.motorMicroseconds(), pair[1]) << pair[0];
  }
  EXPECT_NEAR(fc_.motorOutputs()[0], 0.999, 1e-12);
}

/// 27 levels of throttle: never less thrust for more throttle, full at the end, idle below min_check.
TEST_F(Standin, ThrottleLevels) {
  arm();
  int before = 0;
  for (int level = 0; level < 27; ++level) {
    const int throttle = 1000 + level * 1000 / 26;
    stream(0.06, frame(throttle, 2000));
    EXPECT_GE(fc_.motorMicroseconds(), before);
    before = fc_.motorMicroseconds();
    if (throttle <= 1050) {
      EXPECT_EQ(before, 1070);
    }
  }
  EXPECT_EQ(before, 1999);
}

/// Measured: edges are ramps of 12 to 18 ms.
TEST_F(Standin, EdgesAreRamps) {
  arm();
  for (const auto& [from, to] : {std::pair{1000, 2000}, std::pair{2000, 1000}}) {
    stream(0.1, frame(from, 2000));
    const double low = 1070, range = 1999 - 1070;
    fc_.onFrame(frame(to, 2000), now_);
    const double begin = now_;
    double tenth = 0, half = 0, rest = 0;
    for (int i = 0; i < 40; ++i) {
      silence(0.001);
      const double share = std::abs(fc_.motorMicroseconds() - (from == 1000 ? low : low + range)) / range;
      if (tenth == 0 && share >= 0.1) tenth = now_ - begin;
      if (half == 0 && share >= 0.5) half = now_ - begin;
      if (rest == 0 && share >= 0.9) rest = now_ - begin;
    }
    EXPECT_GE(rest - tenth, 0.0119);
    EXPECT_LE(rest - tenth, 0.0181);
    EXPECT_NEAR(half, 0.011, 0.0011);
  }
}

TEST_F(Standin, StreamStops) {
  arm();
  stream(0.2, frame(1500, 2000));
  now_ -= PERIOD - 0.001;  // the last frame came one period ago; go back to just after it
  fc_.onFrame(frame(1500, 2000), now_);
  const double last = now_;
  silence(0.09);
  EXPECT_FALSE(fc_.armingFlags() & standin::FLAG_RXLOSS);
  silence(0.02);
  EXPECT_TRUE(fc_.armingFlags() & standin::FLAG_RXLOSS);
  while (now_ - last < 0.2995) {
    silence(0.001);
    ASSERT_EQ(fc_.motorMicroseconds(), 1509) << now_ - last;
  }
  while (now_ - last < 0.433) silence(0.001);
  EXPECT_EQ(fc_.motorMicroseconds(), 1070);
  while (now_ - last < 1.4985) {
    silence(0.001);
    ASSERT_TRUE(fc_.armed());
    ASSERT_EQ(fc_.motorMicroseconds(), 1070);
  }
  silence(0.003);
  EXPECT_FALSE(fc_.armed());
  EXPECT_TRUE(fc_.failsafe());
  EXPECT_EQ(fc_.motorMicroseconds(), 1000);
  EXPECT_EQ(fc_.armingFlags(), standin::FLAG_FAILSAFE | standin::FLAG_RXLOSS);
}

/// Measured: idle 319 to 337 ms after the last frame, in 5 % of cases 418 to 432 ms.
TEST_F(Standin, TimesToIdleAfterTheLastFrame) {
  arm();
  int late = 0;
  const int trials = 400;
  for (int trial = 0; trial < trials; ++trial) {
    stream(0.6, frame(1000, 2000));
    stream(0.1, frame(2000, 2000));
    ASSERT_EQ(fc_.motorMicroseconds(), 1999);
    fc_.onFrame(frame(2000, 2000), now_);
    const double last = now_;
    while (fc_.motorMicroseconds() > 1070 && now_ - last < 1.0) silence(0.001);
    const double idle = now_ - last;
    if (idle > 0.37) {
      ++late;
      EXPECT_GE(idle, 0.418);
      EXPECT_LE(idle, 0.432);
    } else {
      EXPECT_GE(idle, 0.319);
      EXPECT_LE(idle, 0.337);
    }
  }
  EXPECT_NEAR(static_cast<double>(late) / trials, 0.05, 0.03);  // three deviations of a count of 20
}

/// iNav keeps full throttle for up to 0.92 s after a kill.
TEST_F(Standin, InavHoldsLonger) {
  standin::StandinSettings settings;
  settings.boot_grace = 0.6;
  settings.becomeInav();
  standin::StandinController inav(settings, now_);
  const auto send = [&](int throttle, int aux1, int frames) {
    for (; frames > 0; --frames) {
      inav.onFrame(frame(throttle, aux1), now_);
      for (int i = 0; i < 20; ++i) inav.step(now_ += 0.001);
    }
  };
  send(1000, 1000, 60);
  send(1000, 2000, 10);
  send(2000, 2000, 10);
  const double last = now_ - PERIOD;
  while (now_ - last < 0.89) inav.step(now_ += 0.001);
  EXPECT_EQ(inav.motorMicroseconds(), 1999);
  while (now_ - last < 1.04) inav.step(now_ += 0.001);
  EXPECT_EQ(inav.motorMicroseconds(), 1070);
}

/// rxfail on HOLD or SET: throttle stays until the second stage.
TEST_F(Standin, RxFailOnHoldOrSetKeepsThrottle) {
  for (const RxFailMode mode : {RxFailMode::HOLD, RxFailMode::SET}) {
    standin::StandinSettings settings;
    settings.boot_grace = 0.6;
    settings.rxfail.channels[3] = {mode, 1700};
    standin::StandinController fc(settings, now_);
    const auto send = [&](int throttle, int aux1, int frames) {
      for (; frames > 0; --frames) {
        fc.onFrame(frame(throttle, aux1), now_);
        for (int i = 0; i < 20; ++i) fc.step(now_ += 0.001);
      }
    };
    send(1000, 1000, 60);
    send(1000, 2000, 10);
    send(2000, 2000, 10);
    const double last = now_ - PERIOD;
    while (now_ - last < 1.49) fc.step(now_ += 0.001);
    EXPECT_EQ(fc.motorMicroseconds(), mode == RxFailMode::HOLD ? 1999 : 1706);
    while (now_ - last < 1.51) fc.step(now_ += 0.001);
    EXPECT_EQ(fc.motorMicroseconds(), 1000);
  }
}

TEST_F(Standin, LimitsCutThePulse) {
  for (const bool motors : {true, false}) {
    standin::StandinSettings settings;
    settings.boot_grace = 0.6;
    if (motors) {
      settings.motor_output_limit = 70;
    } else {
      settings.throttle_limit = {ThrottleLimitType::CLIP, 60};
    }
    standin::StandinController fc(settings, now_);
    for (int k = 0; k < 100; ++k) {
      fc.onFrame(frame(k < 80 ? 1000 : 2000, k < 60 ? 1000 : 2000), now_);
      for (int i = 0; i < 20; ++i) fc.step(now_ += 0.001);
    }
    EXPECT_NEAR(fc.motorMicroseconds(), 1070 + (motors ? 0.7 : 0.6) * 930, 2.0);
  }
}

/// FAILSAFE clears after a second of frames; the switch that stayed on must be off once before it arms.
TEST_F(Standin, FailsafeClearsAfterASecondOfFrames) {
  arm();
  silence(2.0);
  ASSERT_TRUE(fc_.failsafe());
  stream(0.94, frame(1000, 2000));
  EXPECT_TRUE(fc_.failsafe());
  stream(0.1, frame(1000, 2000));
  EXPECT_FALSE(fc_.failsafe());
  stream(2.0, frame(1000, 2000));
  EXPECT_FALSE(fc_.armed());
  EXPECT_EQ(fc_.armingFlags(), standin::FLAG_NOT_DISARMED | standin::FLAG_ARMSWITCH);
  stream(0.1, frame(1000, 1000));
  EXPECT_EQ(fc_.armingFlags(), 0U);
  stream(0.2, frame(1000, 2000));
  EXPECT_TRUE(fc_.armed());
}

TEST_F(Standin, ThrustReturnsWithTheFirstFrameAfterAGap) {
  arm();
  stream(0.1, frame(1500, 2000));
  silence(0.6);
  EXPECT_EQ(fc_.motorMicroseconds(), 1070);
  fc_.onFrame(frame(1500, 2000), now_);
  silence(0.012);
  EXPECT_GT(fc_.motorMicroseconds(), 1290) << "past half: the danger that the bridge must avert";
  silence(0.010);
  EXPECT_EQ(fc_.motorMicroseconds(), 1509);
}

TEST_F(Standin, FourChannelsLeaveTheSwitchHeld) {
  arm();
  stream(2.0, frame(1000, 1000, 4));
  EXPECT_TRUE(fc_.armed());
  stream(0.1, frame(1000, 1000, 5));
  EXPECT_FALSE(fc_.armed());
}

/// Any flight channel, not only throttle: all four are replaced, motors idle, and disarmed 1.5 s later though frames go
/// on.
TEST_F(Standin, OneInvalidFlightChannelIdlesAndEndsInFailsafe) {
  for (const std::size_t channel : {ROLL, PITCH, THROTTLE, YAW}) {
    SCOPED_TRACE(channel);
    stream(6.0, frame(1000, 1000));
    stream(0.2, frame(1000, 2000));
    stream(0.2, frame(1500, 2000));
    const double last_valid = now_ - PERIOD;
    Channels bad = frame(1500, 2000);
    bad.us[channel] = 2200;
    stream(0.26, bad);
    EXPECT_EQ(fc_.motorMicroseconds(), 1509);
    EXPECT_FALSE(fc_.armingFlags() & standin::FLAG_RXLOSS);
    stream(0.1, bad);
    EXPECT_EQ(fc_.motorMicroseconds(), 1070);
    EXPECT_TRUE(fc_.armingFlags() & standin::FLAG_RXLOSS);
    const Channels seen = fc_.seenChannels(now_);
    EXPECT_EQ(seen.us[0], 1500);
    EXPECT_EQ(seen.us[3], 885);
    while (now_ - last_valid < 1.75) stream(PERIOD, bad);
    EXPECT_TRUE(fc_.armed());
    stream(0.1, bad);
    EXPECT_FALSE(fc_.armed());
  }
}

TEST_F(Standin, ShowsChannelsInItsOwnOrder) {
  Channels sent = frame(1234, 1000);
  sent.us[YAW] = 1600;
  fc_.onFrame(sent, now_);
  const Channels seen = fc_.seenChannels(now_);
  EXPECT_EQ(seen.us[2], 1600);
  EXPECT_EQ(seen.us[3], 1234);
}

TEST(StandinMsp, ServesNinetySixCommandsASecondAndBuildsLag) {
  standin::StandinSettings settings;
  standin::StandinController fc(settings, 0.0);
  standin::StandinMsp port(fc, 0.0);
  std::array<std::uint8_t, 64> question{}, rc{};
  const std::size_t size = encodeMsp(request(MspVersion::V2, MSP_STATUS), question.data(), question.size());
  const std::size_t rc_size = encodeMsp(setRawRc(MspVersion::V2, safeChannels()), rc.data(), rc.size());
  std::array<std::uint8_t, 1024> out{};
  int asked = 0;
  double next = 0, lag = 0;
  for (double now = 0; now < 10.0; now += 0.001) {
    while (next <= now) {  // 150 a second: 50 frames, 100 questions
      asked % 3 == 0 ? port.receive(rc.data(), rc_size) : port.receive(question.data(), size);
      ++asked;
      next += 1.0 / 150.0;
    }
    port.step(now, out.data(), out.size());
    if (port.lostBytes() == 0) lag = static_cast<double>(asked - port.served()) / 96.0;
  }
  EXPECT_NEAR(static_cast<double>(port.served()) / 10.0, 96.0, 1.0);
  EXPECT_GT(port.lostBytes(), 3 * 1400);
  EXPECT_NEAR(lag, 1.1, 0.11) << "in seconds, when the ring overran; the measured mix of sizes is not known";
}

/// Measured: 60 frames at once overrun the buffer, and the last one is in force after 66 ms.
TEST(StandinMsp, BurstOverrunsTheBuffer) {
  standin::StandinController fc(standin::StandinSettings{}, 0.0);
  standin::StandinMsp port(fc, 0.0);
  std::array<std::uint8_t, 64> out{};
  for (int k = 0; k < 60; ++k) {
    Channels channels = safeChannels();
    channels.us[THROTTLE] = static_cast<std::uint16_t>(1100 + k);
    const std::size_t size = encodeMsp(setRawRc(MspVersion::V2, channels), out.data(), out.size());
    port.receive(out.data(), size);
  }
  EXPECT_EQ(port.lostBytes(), 1400);
  double now = 0;
  while (fc.seenChannels(now).us[3] != 1159 && now < 1.0) port.step(now += 0.001, out.data(), out.size());
  EXPECT_LT(now, 0.066);
  EXPECT_EQ(fc.frames(), 4);
}

TEST(StandinMsp, RefusesUnknownCommandsAndStaysSilentOnBadChecksum) {
  standin::StandinController fc(standin::StandinSettings{}, 0.0);
  standin::StandinMsp port(fc, 0.0);
  std::array<std::uint8_t, 64> bytes{};
  std::size_t size = encodeMsp(request(MspVersion::V1, 250), bytes.data(), bytes.size());
  port.receive(bytes.data(), size);
  std::array<std::uint8_t, 256> out{};
  size = port.step(0.1, out.data(), out.size());
  ASSERT_GT(size, 3U);
  EXPECT_EQ(out[2], '!');
  size = encodeMsp(request(MspVersion::V1, MSP_STATUS), bytes.data(), bytes.size());
  bytes[size - 1] = static_cast<std::uint8_t>(bytes[size - 1] ^ 0xFF);
  port.receive(bytes.data(), size);
  EXPECT_EQ(port.step(0.2, out.data(), out.size()), 0U);
}

}  // namespace
}  // namespace snapwing::link
