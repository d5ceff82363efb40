#include "snapwing/vehicle/pulse.h"

#include <algorithm>
#include <cmath>

#include "snapwing/common/error.h"
#include "snapwing/common/require.h"

namespace snapwing::vehicle {

namespace {
const common::Require require;
}  // namespace

void Pulse::validateHold() const {
  const common::Require hold("pulse");
  hold.within("hold_duration", hold_duration, 0, 60);
  hold.within("hold_throttle", hold_throttle, 0, 1);
  hold((hold_throttle > 0) == (hold_duration > 0), "hold_throttle", hold_throttle,
       hold_duration > 0 ? "above 0 with a hold_duration" : "0 without a hold_duration");
}

common::ThrottleScale throttleScale(const Radio& radio) {
  return {radio.throttle_low, radio.throttle_high, radio.min_check, radio.motor_idle, radio.motor_full};
}

common::ThrottleScale throttleScaleOf(const std::string& vehicle_file) {
  return throttleScale(loadVehicle(vehicle_file).radio);
}

double throttleMicroseconds(const Radio& radio, double throttle) {
  return common::throttleMicroseconds(throttleScale(radio), throttle);
}

double motorOutputFromMicroseconds(const Radio& radio, double microseconds) {
  if (!std::isfinite(microseconds)) throw common::Error("motor output is not finite; allowed: microseconds");
  return std::clamp((microseconds - common::MOTOR_OFF) / (radio.motor_full - common::MOTOR_OFF), 0.0, 1.0);
}

double motorOutput(const Radio& radio, double throttle) {
  const double stick = throttleMicroseconds(radio, throttle);
  const double above = (stick - radio.min_check) / (radio.throttle_high - radio.min_check);
  const double out = radio.motor_idle + std::max(0.0, above) * (radio.motor_full - radio.motor_idle);
  return motorOutputFromMicroseconds(radio, out);
}

double thrustFraction(double quadratic_share, double motor_output) {
  require.within("motor output", motor_output, 0, 1);
  return motor_output * (quadratic_share * motor_output + (1.0 - quadratic_share));
}

double thrustFraction(double quadratic_share, const Radio& radio, double throttle) {
  return thrustFraction(quadratic_share, motorOutput(radio, throttle));
}

}  // namespace snapwing::vehicle
