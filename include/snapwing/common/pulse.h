#pragma once
/// A thrust pulse and the way from a stick's throttle to thrust.

#include "snapwing/common/vehicle.h"

namespace snapwing::common {

/// Rectangular pulse: throttle for a duration, then throttle low (motors at idle).
struct Pulse {
  double throttle = 0;  ///< [1] stick travel, 0 = throttle_low, 1 = throttle_high
  double duration = 0;  ///< [s]
};

/// One rule for throttle, from the stick to the wire to the motors: the vehicle file's `radio`, and what bridge and
/// operator agree on. [us]
struct ThrottleScale {
  double low = 1000;         ///< stick low
  double high = 2000;        ///< stick full
  double min_check = 1050;   ///< below: motors at idle
  double motor_idle = 1070;  ///< motor output when armed and throttle low
  double motor_full = 2000;
};
constexpr double MOTOR_OFF = 1000;  ///< [us] motor output that turns nothing

ThrottleScale throttleScale(const Radio& radio);
/// The scale of a vehicle file. @throws FileError, SettingError
ThrottleScale throttleScaleOf(const std::string& vehicle_file);

/// Stick throttle [0,1] -> microseconds on the wire.
double throttleMicroseconds(const ThrottleScale& scale, double throttle);
double throttleMicroseconds(const Radio& radio, double throttle);
/// Microseconds on the wire -> stick throttle, clamped to [0,1]. @throws Error if not finite
double throttleFromMicroseconds(const ThrottleScale& scale, double microseconds);

/// Stick throttle [0,1] -> motor output s in [0,1], as the flight controller scales it while armed: idle below
/// min_check, linear above (facts: 1100/1300/1500/1700/2000 us -> 1118/1314/1509/1706/1999).
double motorOutput(const Radio& radio, double throttle);

/// Motor output in microseconds, as the flight controller reports it -> s in [0,1]: MOTOR_OFF is 0, motor_full 1.
double motorOutputFromMicroseconds(const Radio& radio, double microseconds);

/// Motor output s in [0,1] -> share of the full thrust, q s^2 + (1-q) s.
double thrustFraction(double quadratic_share, double motor_output);

/// Throttle whose steady thrust is `fraction` of the full thrust. @param fraction within [idle's, 1]
/// @throws Error if outside
double throttleForThrust(const Vehicle& vehicle, double fraction);

}  // namespace snapwing::common
