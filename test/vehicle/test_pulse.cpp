#include <gtest/gtest.h>

#include <cmath>

#include "snapwing/common/error.h"
#include "snapwing/vehicle/pulse.h"

namespace snapwing::vehicle {
namespace {

Radio radio() {
  Radio r;
  r.throttle_low = 1000;
  r.throttle_high = 2000;
  r.min_check = 1050;
  r.motor_idle = 1070;
  r.motor_full = 2000;
  return r;
}

TEST(Pulse, ScalesAsMeasuredOnTheFlightController) {
  // docs/references.md: microseconds of the stick -> of the motors, read off as whole numbers.
  const double table[][2] = {{1100, 1118}, {1300, 1314}, {1500, 1509}, {1700, 1706}, {2000, 1999}};
  for (const auto& row : table) {
    const double s = motorOutput(radio(), (row[0] - 1000.0) / 1000.0);
    EXPECT_NEAR(1000.0 + 1000.0 * s, row[1], 2.0) << row[0];
  }
}

TEST(Pulse, IdlesBelowMinCheck) {
  EXPECT_DOUBLE_EQ(motorOutput(radio(), 0.0), 0.070);
  EXPECT_DOUBLE_EQ(motorOutput(radio(), 0.049), 0.070);
  EXPECT_GT(motorOutput(radio(), 0.06), 0.070);
  EXPECT_DOUBLE_EQ(motorOutput(radio(), 1.0), 1.0);
}

TEST(Pulse, ReportedMicrosecondsGiveTheSameOutput) {
  EXPECT_DOUBLE_EQ(motorOutputFromMicroseconds(radio(), 1070), motorOutput(radio(), 0.0));
  EXPECT_DOUBLE_EQ(motorOutputFromMicroseconds(radio(), 900), 0.0);
  EXPECT_DOUBLE_EQ(motorOutputFromMicroseconds(radio(), 2100), 1.0);
  EXPECT_THROW(motorOutputFromMicroseconds(radio(), NAN), common::Error);
}

TEST(Pulse, WireAndStickAreInverse) {
  const common::ThrottleScale scale{988, 2012, 1050, 1060, 2000};
  for (const double throttle : {0.0, 0.1, 0.5, 1.0}) {
    EXPECT_NEAR(common::throttleFromMicroseconds(scale, common::throttleMicroseconds(scale, throttle)), throttle,
                1e-15);
  }
  EXPECT_EQ(common::throttleFromMicroseconds(scale, 900), 0.0);
  EXPECT_EQ(common::throttleFromMicroseconds(scale, 2100), 1.0);
  EXPECT_THROW(common::throttleFromMicroseconds(scale, NAN), common::Error);
}

/// The zero of the motors' scale is the motors', not the stick's: another throttle_low does not change what an output
/// of 1070 us is.
TEST(Pulse, MotorsScaleDoesNotHangOnTheStick) {
  Radio r = radio();
  r.throttle_low = 1030;
  EXPECT_DOUBLE_EQ(motorOutputFromMicroseconds(r, 1070), 0.070);
  EXPECT_DOUBLE_EQ(motorOutput(r, 0.0), 0.070);
}

TEST(Pulse, ThrustFractionOfAnOutput) {
  EXPECT_DOUBLE_EQ(thrustFraction(0.8, 0.5), 0.8 * 0.25 + 0.2 * 0.5);
  for (const double q : {0.0, 0.3, 0.8, 1.0}) {
    EXPECT_DOUBLE_EQ(thrustFraction(q, radio(), 0), thrustFraction(q, 0.070)) << "idle motors";
    EXPECT_DOUBLE_EQ(thrustFraction(q, radio(), 1), 1) << q;
  }
}

TEST(Pulse, RefusesThrottleOutsideTheStick) {
  EXPECT_THROW(motorOutput(radio(), -0.01), common::Error);
  EXPECT_THROW(motorOutput(radio(), 1.01), common::Error);
  EXPECT_THROW(motorOutput(radio(), NAN), common::Error);
  EXPECT_THROW(thrustFraction(0.8, NAN), common::Error);
}

}  // namespace
}  // namespace snapwing::vehicle
