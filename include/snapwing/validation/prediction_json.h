#pragma once
/// JSON of predictions, pulses and trials. Keys follow the messages; NaN becomes null.

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "snapwing/rom/prediction.h"
#include "snapwing/vehicle/pulse.h"
#include "snapwing/vehicle/trial.h"
#include "snapwing/vehicle/vehicle.h"

namespace snapwing::validation {

/// What the models of all fidelities say of a trial.
nlohmann::ordered_json outcomeJson(const vehicle::TrialOutcome& outcome);
nlohmann::ordered_json predictionJson(const rom::SnapPrediction& prediction);
nlohmann::ordered_json pulseJson(const vehicle::Pulse& pulse);
/// "for 0.140 s, then throttle 0.330 for 1.200 s".
std::string pulseTimes(const vehicle::Pulse& pulse);
nlohmann::ordered_json trialJson(const vehicle::Trial& trial);
/// Vehicle and table with their hashes. @throws common::FileError
nlohmann::ordered_json inputsJson(const vehicle::Vehicle& vehicle, const std::string& table_file);

}  // namespace snapwing::validation
