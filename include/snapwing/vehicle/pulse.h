#pragma once
/// A thrust pulse and the way from a stick's throttle to thrust.

#include <string>

#include "snapwing/common/throttle_scale.h"
#include "snapwing/vehicle/vehicle.h"

namespace snapwing::vehicle {

/// Thrust pulse: throttle for a duration, then perhaps a second level (the hold), then throttle low (motors at idle).
struct Pulse {
  double throttle = 0;                                       ///< [1] stick travel, 0 = throttle_low, 1 = throttle_high
  double duration = 0;                                       ///< [s]
  double hold_throttle = 0;                                  ///< [1] behind it; above 0 if there is a hold, else 0
  double hold_duration = 0;                                  ///< [s] 0 = no hold
  double whole() const { return duration + hold_duration; }  ///< [s]
  /// @throws common::Error naming the member
  void validateHold() const;
};

/// Steady thrust asked of the motors for a while.
struct ThrustLevel {
  double fraction = 0;  ///< [0, 1] of the full thrust
  double duration = 0;  ///< [s]
};

common::ThrottleScale throttleScale(const Radio& radio);
/// The scale of a vehicle file. @throws common::FileError, common::SettingError
common::ThrottleScale throttleScaleOf(const std::string& vehicle_file);

/// Stick throttle [0,1] -> microseconds on the wire.
double throttleMicroseconds(const Radio& radio, double throttle);

/// Stick throttle [0,1] -> motor output s in [0,1], as the flight controller scales it while armed: idle below
/// min_check, linear above (docs/references.md: 1100/1300/1500/1700/2000 us -> 1118/1314/1509/1706/1999).
double motorOutput(const Radio& radio, double throttle);

/// Motor output in microseconds, as the flight controller reports it -> s in [0,1]: MOTOR_OFF is 0, motor_full 1.
double motorOutputFromMicroseconds(const Radio& radio, double microseconds);

/// Motor output s in [0,1] -> share of the full thrust, q s^2 + (1-q) s.
double thrustFraction(double quadratic_share, double motor_output);
/// The same for a stick throttle [0,1] while armed: 0 is what idle motors give.
double thrustFraction(double quadratic_share, const Radio& radio, double throttle);

}  // namespace snapwing::vehicle
