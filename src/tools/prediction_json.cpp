#include "prediction_json.h"

#include <cmath>
#include <cstdio>

#include "snapwing/common/provenance.h"

namespace snapwing::tools {

using nlohmann::ordered_json;

ordered_json predictionJson(const rom::SnapPrediction& p) {
  return {{"rung", p.rung},
          {"start_mode", vehicle::modeName(p.start_mode)},
          {"end_mode", vehicle::modeName(p.end_mode)},
          {"snapped", p.snapped},
          {"start_held", p.start_held},
          {"snap_time", p.snap_time},
          {"settle_time", p.settle_time},
          {"peak_travel", p.peak_travel},
          {"least_travel", p.least_travel},
          {"end_travel", p.end_travel},
          {"end_speed", p.end_speed},
          {"peak_speed", p.peak_speed},
          {"energy_margin", p.energy_margin},
          {"force_error", p.force_error},
          {"out_of_table", p.out_of_table},
          {"steps", p.steps},
          {"compute_seconds", p.compute_seconds}};
}

ordered_json pulseJson(const vehicle::Pulse& pulse) {
  return {{"throttle", pulse.throttle}, {"duration", pulse.duration}};
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

void checkFiles(const vehicle::Vehicle& vehicle, const std::string& table_file,
                const std::vector<std::pair<std::string, std::string>>& outputs) {
  common::OutputFiles files;
  files.reads(vehicle.file, "the vehicle file");
  files.reads(table_file, "the force table");
  files.reads({vehicle.arm.density_file, vehicle.arm.table_file, vehicle.wing.layout_file, vehicle.wing.table_file},
              "a file that the vehicle file names");
  for (const auto& [path, option] : outputs) files.writes(path, option);
}

std::string chooseTable(const vehicle::Vehicle& vehicle, const std::string& asked) {
  return asked.empty() ? vehicle.arm.table_file : asked;
}

std::string predictionLine(const rom::SnapPrediction& p) {
  char text[400];
  if (p.snapped) {
    std::snprintf(text, sizeof text, "switches %s -> %s, barrier passed %.3f s after the command, margin %+.3f",
                  vehicle::modeName(p.start_mode).c_str(), vehicle::modeName(p.end_mode).c_str(), p.snap_time,
                  p.energy_margin);
  } else if (p.end_mode == vehicle::Mode::UNKNOWN) {
    std::snprintf(text, sizeof text, "starts in %s and has not settled within the horizon",
                  vehicle::modeName(p.start_mode).c_str());
  } else {
    std::snprintf(text, sizeof text, "stays in %s%s, margin %+.3f", vehicle::modeName(p.start_mode).c_str(),
                  std::isnan(p.snap_time) ? "" : " (passed the barrier and came back)", p.energy_margin);
  }
  std::string line = text;
  std::snprintf(text, sizeof text, "; travel %.1f .. %.1f mm, %.1f m/s at the end%s", 1e3 * p.least_travel,
                1e3 * p.peak_travel, p.end_speed, p.out_of_table ? "; left the table (extrapolated)" : "");
  return line + text;
}

}  // namespace snapwing::tools
