#pragma once
/// JSON of predictions and plans, shared by the commands. Keys follow the messages; NaN becomes null.

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "snapwing/rom/prediction.h"
#include "snapwing/vehicle/force_table.h"
#include "snapwing/vehicle/pulse.h"
#include "snapwing/vehicle/trial.h"
#include "snapwing/vehicle/vehicle.h"

namespace snapwing::tools {

nlohmann::ordered_json predictionJson(const rom::SnapPrediction& prediction);
nlohmann::ordered_json pulseJson(const vehicle::Pulse& pulse);
nlohmann::ordered_json trialJson(const vehicle::Trial& trial);
/// Vehicle and table with their hashes.
nlohmann::ordered_json inputsJson(const vehicle::Vehicle& vehicle, const std::string& table_file);

/// Checks outputs (path, option) against what the command reads. @throws common::FileError
void checkFiles(const vehicle::Vehicle& vehicle, const std::string& table_file,
                const std::vector<std::pair<std::string, std::string>>& outputs);

/// The table file asked for, or the vehicle's own.
std::string chooseTable(const vehicle::Vehicle& vehicle, const std::string& asked);

/// One line: "ends in Q, switched after 0.123 s, ..."
std::string predictionLine(const rom::SnapPrediction& prediction);

}  // namespace snapwing::tools
