#pragma once
/// What the commands that predict and plan share: their files, and a prediction in words.

#include <string>
#include <utility>
#include <vector>

#include "snapwing/rom/prediction.h"
#include "snapwing/vehicle/vehicle.h"

namespace snapwing::tools {

/// Checks outputs (path, option) against what the command reads. @throws common::FileError
void checkFiles(const vehicle::Vehicle& vehicle, const std::string& table_file,
                const std::vector<std::pair<std::string, std::string>>& outputs);

/// The table file asked for, or the vehicle's own.
std::string chooseTable(const vehicle::Vehicle& vehicle, const std::string& asked);

/// One line: "ends in Q, switched after 0.123 s, ..."
std::string predictionLine(const rom::SnapPrediction& prediction);

}  // namespace snapwing::tools
