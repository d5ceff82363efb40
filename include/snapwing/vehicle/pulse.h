#pragma once
/// A thrust pulse, and the conversion of stick throttle to thrust.

#include <string>

#include "snapwing/common/throttle_scale.h"
#include "snapwing/vehicle/vehicle.h"

namespace snapwing::vehicle {

/// Thrust pulse: throttle for a duration, then optionally a second level (the hold), then throttle low (motors at
/// idle).
struct Pulse {
  double throttle = 0;                                       ///< [1] stick travel, 0 = throttle_low, 1 = throttle_high
  double duration = 0;                                       ///< [s]
  double hold_throttle = 0;                                  ///< [1] after the pulse; above 0 with a hold, else 0
  double hold_duration = 0;                                  ///< [s] 0 .. 60; 0 = no hold
  double whole() const { return duration + hold_duration; }  ///< [s]
  /// Checks the hold's members. @throws common::Error naming the member
  void validateHold() const;
};

/// Demand of a steady thrust for a duration.
struct ThrustLevel {
  double fraction = 0;  ///< [0, 1] of the full thrust
  double duration = 0;  ///< [s]
};

common::ThrottleScale throttleScale(const Radio& radio);
/// The scale of a vehicle file. @throws common::FileError, common::SettingError
common::ThrottleScale throttleScaleOf(const std::string& vehicle_file);

/// Stick throttle [0,1] -> microseconds on the wire. @throws common::Error outside
double throttleMicroseconds(const Radio& radio, double throttle);

/// Stick throttle [0,1] -> motor output s in [0,1], as the flight controller scales it while armed: idle below
/// min_check, linear above (docs/references.md: 1100/1300/1500/1700/2000 us -> 1118/1314/1509/1706/1999).
/// @throws common::Error for a throttle outside [0,1]
double motorOutput(const Radio& radio, double throttle);

/// Motor output in microseconds, as the flight controller reports it -> s, clamped to [0,1]: MOTOR_OFF is 0, motor_full
/// is 1. @throws common::Error if not finite
double motorOutputFromMicroseconds(const Radio& radio, double microseconds);

/// Motor output s in [0,1] -> share of the full thrust [1], q s^2 + (1-q) s. @throws common::Error outside
double thrustFraction(double quadratic_share, double motor_output);
/// Likewise of a stick throttle [0,1] while armed; throttle 0 gives the thrust of idle motors.
double thrustFraction(double quadratic_share, const Radio& radio, double throttle);

}  // namespace snapwing::vehicle
