#include <cmath>
#include <string>

#include "snapwing/common/plain_text.h"
#include "snapwing/common/require.h"
#include "snapwing/planning/pulse_planner.h"

namespace snapwing::planning {

namespace {
const common::Require require("planner");

/// Two bounds of a pulse. Where they cross, the upper one is named: it is the one that `snapwing plan` lets a user
/// give.
void requireBounds(const std::string& quantity, double min, double max, double most, const std::string& unit) {
  const std::string lower = quantity + "_min", upper = quantity + "_max", up_to = common::toText(most) + unit;
  require(min >= 0 && min < most, lower, min, "0 .. below " + up_to);
  require(max > min && max <= most, upper, max,
          "above " + lower + " (" + common::toText(min) + unit + "), up to " + up_to);
}
}  // namespace

void PlannerSettings::validate() const {
  requireBounds("throttle", throttle_min, throttle_max, 1, "");
  requireBounds("duration", duration_min, duration_max, 10, " s");
  pulse(vehicle::Mode::FIXED_WING, throttle_max, duration_max).validateHold();
  require(scan_throttles >= 2 && scan_throttles <= 1000, "scan_throttles", scan_throttles, "2 .. 1000");
  require(scan_durations >= 2 && scan_durations <= 1000, "scan_durations", scan_durations, "2 .. 1000");
  require(search_samples >= 1 && search_samples <= 100000, "search_samples", search_samples, "1 .. 100000");
  require(verify_samples >= 1 && verify_samples <= 1000000, "verify_samples", verify_samples, "1 .. 1000000");
  require(corner_parameters >= 0 && corner_parameters <= 8, "corner_parameters", corner_parameters, "0 .. 8");
  require(refine_evaluations >= 0 && refine_evaluations <= 100000, "refine_evaluations", refine_evaluations,
          "0 .. 100000");
  require(std::isfinite(required_margin) && required_margin >= 0, "required_margin", required_margin, "0 or more");
  require(std::isfinite(enough_margin) && enough_margin >= required_margin, "enough_margin", enough_margin,
          "required_margin or more");
  require(required_share > 0 && required_share <= 1, "required_share", required_share, "above 0, up to 1");
  require(std::isfinite(impulse_price) && impulse_price >= 0, "impulse_price", impulse_price, "0 or more, 1/s");
  require(frame_jitter >= 0 && frame_jitter <= 10, "frame_jitter", frame_jitter, "0 .. 10 frames");
  require(threads >= 1 && threads <= 256, "threads", threads, "1 .. 256");
  require(model_step > 0 && model_step <= 0.01, "model_step", model_step, "above 0, up to 0.01 s");
  model.validate();
}

}  // namespace snapwing::planning
