#pragma once
/// A vehicle file put to the test, with its report in a folder: what `snapwing validate` and the action of the same
/// name do.

#include <functional>
#include <string>
#include <vector>

#include "snapwing/validation/validation.h"

namespace snapwing::pipeline {

struct ValidateJob {
  std::string vehicle_file;
  std::string folder;              ///< of report.html, validation.json and trials/; made if it is not there
  std::vector<std::string> plans;  ///< [JSON]; empty: those that the vehicle file names, else one each way is planned
  validation::ValidationSettings settings;
  std::string command;  ///< as the report shows it
  std::function<void(int done, int all, const std::string& what)> progress;
  std::function<void(const std::string& why)> note;  ///< results in the folder that are computed anew
  std::function<bool()> cancelled;
};

struct VehicleValidation {
  validation::Validation found;
  std::string vehicle;      ///< its name
  std::string report_file;  ///< report.html
};

/// A table that is not the vehicle's own is a failed check. Trials are kept one by one, so that the same job resumes
/// with one that was ended; a cancelled one leaves no report.
/// @throws common::Error for bad input
VehicleValidation validateVehicle(const ValidateJob& job);

/// Everything that an answer depends on but the files and the number of threads, as text.
std::string settingsText(const validation::ValidationSettings& settings);

/// "NAME: VALUE UNIT (allowed ...): words", one line of an answer.
std::string checkLine(const validation::Check& check);

/// 0 passed, 1 failed, 3 undecided.
int exitCodeOf(validation::Verdict verdict);

}  // namespace snapwing::pipeline
