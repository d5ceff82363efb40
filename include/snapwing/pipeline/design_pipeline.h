#pragma once
/// From what an arm is to do to a vehicle file that may fly it: design, check and tables, wing, vehicle file, a plan
/// each way, validation. Each stage's result lies in one folder:
///
///     design/        density.csv, body.csv, table.h5, curves, parts, report.json
///     wing/          wing.yaml, wing_table.h5 (a vehicle with wings)
///     vehicle.yaml   the vehicle with the new arm, that names all of the others
///     plan_f_to_q.json, plan_q_to_f.json
///     validation/    report.html, validation.json
///     stages/        inputs of each stage: an interrupted run resumes (stages.h)

#include <functional>
#include <string>
#include <vector>

#include "snapwing/pipeline/stages.h"
#include "snapwing/validation/validation.h"

namespace snapwing::pipeline {

struct DesignPipelineSettings {
  std::string vehicle_file;   ///< whose arm is designed; it is not changed
  std::string arm_settings;   ///< of `snapwing design arm`; empty: arm_design.yaml beside the vehicle file
  std::string density;        ///< [CSV] to be checked in place of an optimisation; empty: none
  std::string wing_settings;  ///< of `snapwing design wing`; empty: the vehicle's own wing gets a new table
  std::string folder;
  int threads = 0;  ///< 0: the settings' own. Changes no bit
  validation::ValidationSettings validation;
};

struct DesignPipelineHooks {
  std::function<void(const StageProgress&)> progress;
  std::function<void(const std::string&)> warning;
  std::function<bool()> cancelled;  ///< polled; true ends the run, which resumes with the same settings
};

struct DesignPipelineResult {
  bool cancelled = false;
  std::vector<StageResult> stages;  ///< that were done or kept
  std::string vehicle_file;         ///< empty if the run ended before it
  std::string report_file;          ///< of the validation; empty likewise
  /// FAIL if a stage failed, else UNDECIDED if one is, else PASS.
  validation::Verdict verdict() const;
};

/// @throws common::Error for bad input, before the work
DesignPipelineResult designPipeline(const DesignPipelineSettings& settings, const DesignPipelineHooks& hooks);

/// Where the settings of an arm are looked for if none are named. @throws common::FileError if they are not there
std::string armSettingsBeside(const std::string& vehicle_file);

}  // namespace snapwing::pipeline
