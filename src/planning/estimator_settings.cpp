#include <cmath>
#include <string>

#include "snapwing/common/require.h"
#include "snapwing/planning/mode_estimator.h"

namespace snapwing::planning {

namespace {

const common::Require require("mode estimator");

}  // namespace

void EstimatorSettings::validate() const {
  require(particles >= 10 && particles <= 1000000, "particles", particles, "10 .. 1000000");
  require(accelerometer_noise > 0 && std::isfinite(accelerometer_noise), "accelerometer_noise", accelerometer_noise,
          "above 0 m/s2");
  require(accelerometer_bias >= 0 && std::isfinite(accelerometer_bias), "accelerometer_bias", accelerometer_bias,
          "0 m/s2 or more");
  require(correlation_time > 0 && correlation_time <= 10, "correlation_time", correlation_time, "above 0, up to 10 s");
  require(process_noise >= 0 && std::isfinite(process_noise), "process_noise", process_noise, "0 or more");
  require(model_error >= 0 && model_error < 1, "model_error", model_error, "0 .. below 1");
  require(outside_force >= 0 && outside_force <= 1000, "outside_force", outside_force, "0 .. 1000 N");
  require(outside_rate >= 0 && outside_rate <= 100, "outside_rate", outside_rate, "0 .. 100 per s");
  require(outside_time >= 0.01 && outside_time <= 100, "outside_time", outside_time, "0.01 .. 100 s");
  require(output_delay >= 0 && output_delay <= 1, "output_delay", output_delay, "0 .. 1 s");
  require(travel_error >= 0 && travel_error <= 0.01, "travel_error", travel_error, "0 .. 0.01 m");
  require(outlier_share >= 0 && outlier_share < 1, "outlier_share", outlier_share, "0 .. below 1");
  require(step > 0 && step <= 0.01, "step", step, "above 0, up to 0.01 s");
  require(hurried_step >= step && hurried_step <= 0.01, "hurried_step", hurried_step, "step .. 0.01 s");
  require(longest_gap >= 0.01 && longest_gap <= 10, "longest_gap", longest_gap, "0.01 .. 10 s");
  require(least_effective >= 0 && least_effective < 0.5, "least_effective", least_effective, "0 .. below 0.5");
  require(sure > 0.5 && sure < 1, "sure", sure, "between 0.5 and 1");
  require(std::abs(gravity) <= 100, "gravity", gravity, "-100 .. 100 m/s2");
}

double ModeEstimate::travelIn(vehicle::Mode in) const {
  const double there = in == vehicle::Mode::QUADROTOR ? travel_quadrotor : travel_fixed_wing;
  return std::isfinite(there) ? there : travel;
}

}  // namespace snapwing::planning
