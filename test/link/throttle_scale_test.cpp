/// One rule for throttle from the command to the motors, and what happens if two programs have two.
#include <gtest/gtest.h>

#include "lcm_messages.h"
#include "link/loop_simulation.h"
#include "snapwing/common/error.h"
#include "snapwing/vehicle/pulse.h"

namespace snapwing::link {
namespace {

using test::Simulation;

/// Wire and motors while a pulse of `throttle` is in force.
struct Seen {
  int wire = 0, motor = 0;
};
Seen pulseSeen(const common::ThrottleScale& scale, double throttle) {
  standin::StandinSettings standin = Simulation::quickStandin();
  standin.min_check = standin.rx_config.min_check = static_cast<int>(scale.min_check);
  standin.motor_idle = static_cast<int>(scale.motor_idle);
  BridgeSettings settings;
  settings.useScale(scale);
  Simulation s(standin, settings);
  s.arm();
  s.command(throttle, 0.3);
  s.run(0.15);
  return {s.fc.seenChannels(s.now).us[3], s.fc.motorMicroseconds()};
}

/// 27 levels: wire and motors are what common says, and so what plan and estimate reckon with.
TEST(ThrottleScale, TwentySevenLevelsReachTheMotorsAsPlanned) {
  for (int level = 0; level <= 26; ++level) {
    const double throttle = level / 26.0;
    const Seen seen = pulseSeen({}, throttle);
    EXPECT_NEAR(seen.wire, common::throttleMicroseconds(common::ThrottleScale{}, throttle), 0.5) << level;
    vehicle::Radio radio;
    radio.throttle_low = 1000, radio.throttle_high = 2000, radio.min_check = 1050;
    radio.motor_idle = 1070, radio.motor_full = 2000;
    const double planned =
        common::MOTOR_OFF + vehicle::motorOutput(radio, throttle) * (radio.motor_full - common::MOTOR_OFF);
    EXPECT_NEAR(seen.motor, planned, 2.0) << level << ": whole thousandths, rounded down";
  }
}

TEST(ThrottleScale, AnotherVehiclesScaleReachesTheWire) {
  const common::ThrottleScale scale{1020, 1900, 1100, 1120, 2000};
  for (const double throttle : {0.25, 0.5, 1.0}) {
    EXPECT_NEAR(pulseSeen(scale, throttle).wire, 1020 + 880 * throttle, 0.5);
  }
}

TEST(ThrottleScale, ControllersOwnLowThrottleMustAgree) {
  standin::StandinSettings standin = Simulation::quickStandin();
  BridgeSettings settings;
  settings.throttle.min_check = 1100;
  Simulation s(standin, settings);
  s.run(1.5);
  EXPECT_EQ(s.bridge->watch().failedCheck(), Check::MIN_CHECK);
}

TEST(ThrottleScale, TwoScalesAreNamed) {
  common::ThrottleScale bridge, vehicle;
  EXPECT_EQ(scaleMismatch(bridge, vehicle), "");
  vehicle.high = 1900;
  vehicle.motor_idle = 1055;
  const std::string text = scaleMismatch(bridge, vehicle);
  EXPECT_NE(text.find("radio.throttle_high is 2000 us at the radio bridge and 1900 us in the vehicle file"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("radio.motor_idle"), std::string::npos);
  EXPECT_EQ(text.find("throttle_low"), std::string::npos);
  EXPECT_NE(text.find("--vehicle-file"), std::string::npos);
}

TEST(ThrottleScale, TravelsWithTheStatus) {
  BridgeStatus sent, got;
  sent.throttle = {1020, 1900, 1100, 1120, 1990};
  ASSERT_TRUE(fromLcm(toLcm(sent, Stamp{}, 0), got));
  EXPECT_EQ(scaleMismatch(sent.throttle, got.throttle), "");
  EXPECT_EQ(got.throttle.motor_full, 1990);
}

TEST(ThrottleScale, SenselessScalesAreRefused) {
  const common::ThrottleScale senseless[] = {
      {1000, 2000, 990, 1070, 2000},   // throttle low would be thrust
      {1060, 2000, 1050, 1070, 2000},  // throttle 0 too
      {1000, 1040, 1050, 1070, 2000},  // never any
      {1000, 2200, 1050, 1070, 2000},  // invalid on the wire
  };
  for (const common::ThrottleScale& scale : senseless) {
    BridgeSettings settings;
    settings.throttle = scale;
    EXPECT_THROW(settings.validate(), common::SettingError) << scale.low << " " << scale.high << " " << scale.min_check;
  }
}

}  // namespace
}  // namespace snapwing::link
