#pragma once
/// Conversion of stick throttle to microseconds on the wire.

namespace snapwing::common {

/// Scale of throttle from stick to wire to motors, from the vehicle file's `radio`; the same in bridge and operator.
/// [us]
struct ThrottleScale {
  double low = 1000;         ///< stick low
  double high = 2000;        ///< stick full
  double min_check = 1050;   ///< below: motors at idle
  double motor_idle = 1070;  ///< motor output when armed and throttle low
  double motor_full = 2000;  ///< full motor output
};
constexpr double MOTOR_OFF = 1000;  ///< [us] motor output of stopped motors

/// Stick throttle [0,1] -> microseconds on the wire. @throws Error outside
double throttleMicroseconds(const ThrottleScale& scale, double throttle);
/// Microseconds on the wire -> stick throttle, clamped to [0,1]. @throws Error if not finite
double throttleFromMicroseconds(const ThrottleScale& scale, double microseconds);

}  // namespace snapwing::common
