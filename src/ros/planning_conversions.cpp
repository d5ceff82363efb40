#include "planning_conversions.h"

#include "conversions.h"

namespace snapwing::nodes {

SnapPrediction toMessage(const rom::SnapPrediction& prediction) {
  SnapPrediction message;
  message.rung = prediction.rung;
  message.start_mode = toMessage(prediction.start_mode);
  message.end_mode = toMessage(prediction.end_mode);
  message.snapped = prediction.snapped;
  message.snap_time = prediction.snap_time;
  message.peak_travel = prediction.peak_travel;
  message.least_travel = prediction.least_travel;
  message.end_travel = prediction.end_travel;
  message.end_speed = prediction.end_speed;
  message.energy_margin = prediction.energy_margin;
  message.force_error = prediction.force_error;
  message.out_of_table = prediction.out_of_table;
  message.compute_seconds = prediction.compute_seconds;
  return message;
}

TransitionPlan toMessage(const planning::TransitionPlan& plan) {
  TransitionPlan message;
  message.start_mode = toMessage(plan.start_mode);
  message.target_mode = toMessage(plan.target_mode);
  message.accepted = plan.accepted;
  message.reason = plan.reason;
  message.pulse = toMessage(plan.pulse);
  message.thrust_fraction = plan.thrust_fraction;
  message.worst_margin = plan.worst_margin;
  message.share_switched = plan.share_switched;
  message.realisations = static_cast<std::uint32_t>(plan.realisations);
  message.compute_seconds = plan.compute_seconds;
  message.nominal = toMessage(plan.nominal);
  message.worst = toMessage(plan.worst);
  return message;
}

vehicle::Trial readTrial(Params& params, const vehicle::Vehicle& vehicle) {
  vehicle::Trial trial;
  trial.mount = vehicle::mountFor(vehicle, params.choice("mount", {"auto", "free", "boom", "held"}), "mount");
  trial.wings = vehicle::wingsFromName(params.choice("wings", {"auto", "on", "off"}));
  trial.gravity = params.number("gravity", {-9.83, 9.83}, "m/s2");
  trial.horizon = params.number("horizon", {0.1, 20.0}, "s");
  trial.validate();
  return trial;
}

}  // namespace snapwing::nodes
