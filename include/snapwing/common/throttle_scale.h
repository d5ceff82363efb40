#pragma once
/// Throttle between the stick and the wire.

namespace snapwing::common {

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

/// Stick throttle [0,1] -> microseconds on the wire. @throws Error outside
double throttleMicroseconds(const ThrottleScale& scale, double throttle);
/// Microseconds on the wire -> stick throttle, clamped to [0,1]. @throws Error if not finite
double throttleFromMicroseconds(const ThrottleScale& scale, double microseconds);

}  // namespace snapwing::common
