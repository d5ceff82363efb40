#include "prediction_text.h"

#include <cmath>
#include <cstdio>

#include "snapwing/common/output_file.h"

namespace snapwing::tools {

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
