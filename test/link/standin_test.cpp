/// The stand-in flight controller against the measured rules, on a fake clock.
#include <gtest/gtest.h>

#include "snapwing/link/standin_controller.h"

namespace snapwing::link {
namespace {

class Standin : public ::testing::Test {
 protected:
  static constexpr double PERIOD = 0.02;

  explicit Standin(double boot_grace = 5.0) : fc_(settings(boot_grace), 0.0) {}
  static StandinSettings settings(double boot_grace) {
    StandinSettings s;
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

  StandinController fc_;
  double now_ = 0;
};

TEST_F(Standin, FlagsAfterPowerOn) {
  EXPECT_EQ(fc_.armingFlags(), FLAG_RXLOSS | FLAG_BOOTGRACE);
  stream(0.48, frame(1000, 1000));
  EXPECT_TRUE(fc_.armingFlags() & FLAG_RXLOSS);
  stream(0.04, frame(1000, 1000));
  EXPECT_EQ(fc_.armingFlags(), static_cast<std::uint32_t>(FLAG_BOOTGRACE));
  stream(4.5, frame(1000, 1000));
  EXPECT_EQ(fc_.armingFlags(), 0U);
}

TEST_F(Standin, ArmsInFortyMilliseconds) {
  stream(6.0, frame(1000, 1000));
  fc_.onFrame(frame(1000, 1700), now_);
  silence(0.039);
  EXPECT_FALSE(fc_.armed());
  silence(0.002);
  EXPECT_TRUE(fc_.armed());
  EXPECT_EQ(fc_.motorMicroseconds(), 1070);
}

TEST_F(Standin, SwitchBelowThresholdDoesNotArm) {
  stream(6.0, frame(1000, 1000));
  stream(0.5, frame(1000, 1699));
  EXPECT_FALSE(fc_.armed());
}

TEST_F(Standin, SwitchOnAtFirstFrameMustBeOffOnce) {
  stream(7.0, frame(1000, 2000));
  EXPECT_FALSE(fc_.armed());
  EXPECT_TRUE(fc_.armingFlags() & FLAG_NOT_DISARMED);
  stream(0.1, frame(1000, 1000));
  EXPECT_EQ(fc_.armingFlags(), 0U);
  stream(0.1, frame(1000, 2000));
  EXPECT_TRUE(fc_.armed());
}

TEST_F(Standin, ThrottleHighWhenSwitched) {
  stream(6.0, frame(1000, 1000));
  stream(0.2, frame(1300, 2000));
  EXPECT_FALSE(fc_.armed());
  EXPECT_EQ(fc_.armingFlags(), FLAG_THROTTLE | FLAG_ARMSWITCH);
  stream(0.5, frame(1000, 2000));
  EXPECT_FALSE(fc_.armed()) << "lowering the throttle alone does not arm";
  EXPECT_EQ(fc_.armingFlags(), static_cast<std::uint32_t>(FLAG_ARMSWITCH));
  stream(0.1, frame(1000, 1000));
  stream(0.1, frame(1000, 2000));
  EXPECT_TRUE(fc_.armed());
}

TEST_F(Standin, BootGraceAndSwitch) {
  stream(1.0, frame(1000, 1000));
  stream(5.0, frame(1000, 2000));  // switched during boot grace
  EXPECT_FALSE(fc_.armed());
  EXPECT_TRUE(fc_.armingFlags() & FLAG_ARMSWITCH);
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

TEST_F(Standin, StreamStops) {
  arm();
  stream(0.2, frame(1500, 2000));
  now_ -= PERIOD - 0.001;  // the last frame came one period ago; go back to just after it
  fc_.onFrame(frame(1500, 2000), now_);
  const double last = now_;
  silence(0.09);
  EXPECT_FALSE(fc_.armingFlags() & FLAG_RXLOSS);
  silence(0.02);
  EXPECT_TRUE(fc_.armingFlags() & FLAG_RXLOSS);
  while (now_ - last < 0.2785) {
    silence(0.001);
    ASSERT_EQ(fc_.motorMicroseconds(), 1509) << now_ - last;
  }
  silence(0.002);
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
  EXPECT_EQ(fc_.armingFlags(), FLAG_FAILSAFE | FLAG_RXLOSS);
}

TEST_F(Standin, FailsafeNeedsFramesForASecondAndSwitchOff) {
  arm();
  silence(2.0);
  ASSERT_TRUE(fc_.failsafe());
  stream(3.0, frame(1000, 2000));
  EXPECT_TRUE(fc_.failsafe()) << "the switch is still on";
  EXPECT_FALSE(fc_.armed());
  silence(0.5);
  stream(0.96, frame(1000, 1000));
  EXPECT_TRUE(fc_.failsafe());
  stream(0.08, frame(1000, 1000));
  EXPECT_FALSE(fc_.failsafe());
  stream(0.2, frame(1000, 2000));
  EXPECT_TRUE(fc_.armed());
}

TEST_F(Standin, ThrustReturnsTwentyMillisecondsAfterAGap) {
  arm();
  stream(0.1, frame(1500, 2000));
  silence(0.6);
  EXPECT_EQ(fc_.motorMicroseconds(), 1070);
  fc_.onFrame(frame(1500, 2000), now_);
  silence(0.018);
  EXPECT_EQ(fc_.motorMicroseconds(), 1070);
  silence(0.003);
  EXPECT_EQ(fc_.motorMicroseconds(), 1509) << "the danger that the bridge must avert";
}

TEST_F(Standin, FourChannelsLeaveTheSwitchHeld) {
  arm();
  stream(2.0, frame(1000, 1000, 4));
  EXPECT_TRUE(fc_.armed());
  stream(0.04, frame(1000, 1000, 5));
  EXPECT_FALSE(fc_.armed());
}

TEST_F(Standin, InvalidThrottleEndsInFailsafeThoughFramesGoOn) {
  arm();
  stream(0.2, frame(1500, 2000));
  const double last_valid = now_ - PERIOD;
  stream(0.24, frame(2200, 2000));
  EXPECT_EQ(fc_.motorMicroseconds(), 1509);
  EXPECT_FALSE(fc_.armingFlags() & FLAG_RXLOSS);
  stream(0.2, frame(2200, 2000));
  EXPECT_EQ(fc_.motorMicroseconds(), 1070);
  EXPECT_TRUE(fc_.armingFlags() & FLAG_RXLOSS);
  EXPECT_EQ(fc_.seenChannels(now_).us[3], 885);
  while (now_ - last_valid < 1.70) stream(PERIOD, frame(2200, 2000));
  EXPECT_TRUE(fc_.armed());
  stream(0.3, frame(2200, 2000));
  EXPECT_FALSE(fc_.armed());
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
  StandinSettings settings;
  StandinController fc(settings, 0.0);
  StandinMsp port(fc, 0.0);
  std::array<std::uint8_t, 64> question{};
  const std::size_t size = encodeMsp(request(MspVersion::V2, MSP_STATUS), question.data(), question.size());
  std::array<std::uint8_t, 1024> out{};
  int asked = 0;
  double next = 0;
  for (double now = 0; now < 10.0; now += 0.001) {
    while (next <= now) {  // 150 a second
      port.receive(question.data(), size);
      ++asked;
      next += 1.0 / 150.0;
    }
    port.step(now, out.data(), out.size());
  }
  EXPECT_NEAR(static_cast<double>(port.served()) / 10.0, 96.0, 1.0);
  EXPECT_GT(port.lostCommands(), 300);
  EXPECT_NEAR(static_cast<double>(asked - port.served() - port.lostCommands()) / 96.0, 1.1, 0.05) << "lag in seconds";
}

TEST(StandinMsp, RefusesUnknownCommandsAndStaysSilentOnBadChecksum) {
  StandinController fc(StandinSettings{}, 0.0);
  StandinMsp port(fc, 0.0);
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
