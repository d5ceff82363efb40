#include "snapwing/validation/prediction_json.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "snapwing/common/provenance.h"

namespace snapwing::validation {

using nlohmann::ordered_json;

ordered_json outcomeJson(const vehicle::TrialOutcome& o) {
  return {{"start_mode", vehicle::modeName(o.start_mode)},
          {"end_mode", vehicle::modeName(o.end_mode)},
          {"snapped", o.snapped},
          {"start_held", o.start_held},
          {"snap_time", o.snap_time},
          {"settle_time", o.settle_time},
          {"peak_travel", o.peak_travel},
          {"least_travel", o.least_travel},
          {"end_travel", o.end_travel},
          {"end_speed", o.end_speed},
          {"peak_speed", o.peak_speed}};
}

ordered_json predictionJson(const rom::SnapPrediction& p) {
  ordered_json json = {{"rung", p.rung}};
  json.update(outcomeJson(p));
  json.update({{"energy_margin", p.energy_margin},
               {"force_error", p.force_error},
               {"out_of_table", p.out_of_table},
               {"steps", p.steps},
               {"compute_seconds", p.compute_seconds}});
  return json;
}

ordered_json pulseJson(const vehicle::Pulse& pulse) {
  ordered_json json = {{"throttle", pulse.throttle}, {"duration", pulse.duration}};
  if (pulse.hold_duration > 0) {
    json["hold_throttle"] = pulse.hold_throttle;
    json["hold_duration"] = pulse.hold_duration;
  }
  return json;
}

std::string pulseTimes(const vehicle::Pulse& pulse) {
  char text[96];
  if (pulse.hold_duration > 0) {
    std::snprintf(text, sizeof text, "for %.3f s, then throttle %.3f for %.3f s", pulse.duration, pulse.hold_throttle,
                  pulse.hold_duration);
  } else {
    std::snprintf(text, sizeof text, "for %.3f s", pulse.duration);
  }
  return text;
}

ordered_json trialJson(const vehicle::Trial& trial) {
  ordered_json json = {{"mount", vehicle::mountName(trial.mount)},
                       {"wings", vehicle::wingsName(trial.wings)},
                       {"gravity", trial.gravity},
                       {"initial_speed", trial.initial_speed},
                       {"push", trial.push},
                       {"horizon", trial.horizon}};
  if (trial.initial_thrust_fraction) json["initial_thrust_fraction"] = *trial.initial_thrust_fraction;
  if (trial.final_thrust_fraction) json["final_thrust_fraction"] = *trial.final_thrust_fraction;
  return json;
}

ordered_json inputsJson(const vehicle::Vehicle& vehicle, const std::string& table_file) {
  ordered_json json = {{"vehicle", vehicle.name},
                       {"vehicle_file", vehicle.file},
                       {"vehicle_sha256", vehicle.sha256},
                       {"table_file", table_file},
                       {"table_sha256", common::sha256OfFile(table_file)}};
  if (!vehicle.wing.table_file.empty()) {
    json["wing_table_file"] = vehicle.wing.table_file;
    json["wing_table_sha256"] = common::sha256OfFile(vehicle.wing.table_file);
  }
  json["snapwing_version"] = common::version();
  return json;
}

}  // namespace snapwing::validation
