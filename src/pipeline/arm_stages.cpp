#include "arm_stages.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"
#include "snapwing/design/design_program.h"

namespace snapwing::pipeline {

namespace {

using design::OptimizerStatus;
using validation::Verdict;
namespace fs = std::filesystem;

/// What the check left in the folder: all but what the optimiser keeps for itself.
std::vector<std::string> filesOf(const std::string& folder, const std::string& name) {
  const std::set<std::string> own = {"history.csv", "history.h5", "checkpoint.h5"};
  std::vector<std::string> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file() || own.count(entry.path().filename().string()) > 0) continue;
    files.push_back(name + "/" + entry.path().lexically_relative(folder).string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Verdict and words of a check.
StageResult judged(const design::ArmCheck& check) {
  StageResult result;
  result.ends = !check.bistable;
  result.words = check.bistable ? "bistable" : "NOT bistable: no plan can follow";
  if (result.ends) result.verdict = Verdict::FAIL;
  for (const design::ArmTarget& target : check.targets) {
    if (target.met()) continue;
    char found[80];
    std::snprintf(found, sizeof found, ", found %.4g .. %.4g: ", target.low, target.high);
    result.words += "; " + target.name + ", wanted " + target.wanted + found + design::nameOf(target.verdict);
    const bool open = target.verdict == design::Verdict::NOT_DECIDED;
    if (result.verdict != Verdict::FAIL) result.verdict = open ? Verdict::UNDECIDED : Verdict::FAIL;
  }
  return result;
}

}  // namespace

ArmStages::ArmStages(const DesignPipelineSettings& settings, const DesignPipelineHooks& hooks)
    : settings_file_(settings.arm_settings.empty() ? armSettingsBeside(settings.vehicle_file) : settings.arm_settings),
      given_(settings.density),
      hooks_(hooks) {
  settings_ = design::loadArmDesignSettings(settings_file_, settings.vehicle_file);
  if (settings.threads > 0) settings_.threads = settings.threads;
  if (!given_.empty()) design::loadDesignedDensity(settings_, given_);  // bad input is refused before the work
}

Inputs ArmStages::madeOf() const {
  return {{"program", design::designProgram()},
          {"vehicle file", settings_.vehicle.sha256},
          {"arm settings", common::sha256OfFile(settings_file_)}};
}

design::ArmRun ArmStages::run(Stages& stages, bool resume) {
  design::ArmRunOptions options;
  options.folder = stages.path("design");
  options.resume = resume;
  options.checkpoint_every = 1;
  options.warning = hooks_.warning;
  options.progress = [&](const design::ArmProgress& p) {
    const int all = settings_.iterations(), done = p.report.iteration + 1;
    char words[120];
    std::snprintf(words, sizeof words, "iteration %d of %d, objective %.4f, violation %.4f", done, all,
                  p.report.objective, p.report.violation);
    stages.working(words, static_cast<double>(done) / all);
    return hooks_.cancelled && hooks_.cancelled();
  };
  design::ArmRun run = design::runArmDesign(settings_, options);
  if (run.result.status == OptimizerStatus::CANCELLED) throw Cancelled{};
  return run;
}

StageResult ArmStages::optimise(Stages& stages) {
  return stages.run("optimisation", madeOf(), [&](bool goes_on) {
    run_ = run(stages, goes_on);
    StageResult result;
    const OptimizerStatus status = run_->result.status;
    result.words = design::nameOf(status) + (run_->result.message.empty() ? "" : ": " + run_->result.message);
    result.ends = status == OptimizerStatus::EVALUATION_FAILED || status == OptimizerStatus::NOT_RUN;
    if (result.ends) result.verdict = Verdict::FAIL;
    if (status == OptimizerStatus::INFEASIBLE) result.words += "; the check decides";
    design::saveDensityCsv(run_->field, "density of arm design '" + settings_.name + "', inputs " + settings_.hash(),
                           stages.path(ARM_DENSITY));
    result.files = {ARM_DENSITY};
    return result;
  });
}

int ArmStages::bodies() const {
  return 1 +
         static_cast<int>(settings_.check_cells.size() + settings_.check_quadratic_cells.size() +
                          settings_.check_volumetric_cells.size()) +
         (settings_.check_offset > 0 ? 2 : 0);
}

design::ArmOutcome ArmStages::checked(Stages& stages, design::ArmCheck* check) {
  design::ArmJob job;
  job.folder = stages.path("design");
  job.warning = hooks_.warning;
  int begun = 0;
  job.checking = [&](const std::string& body) {
    if (!body.empty()) {
      stages.working("body of " + body, std::min(1.0, static_cast<double>(begun) / bodies()));
      ++begun;
    }
    return hooks_.cancelled && hooks_.cancelled();
  };
  job.checked = [check](const design::ArmCheck& found) { *check = found; };
  if (!optimises()) return design::checkArmDensity(settings_, design::loadDesignedDensity(settings_, given_), job);
  if (!run_) run_ = run(stages, true);  // its last iteration, from the checkpoint
  return design::finishArmDesign(settings_, *run_, job);
}

StageResult ArmStages::check(Stages& stages) {
  Inputs inputs = madeOf();
  inputs.emplace_back("density", common::sha256OfFile(optimises() ? stages.path(ARM_DENSITY) : given_));
  return stages.run("check and tables", inputs, [&](bool) {
    design::ArmCheck check;
    const design::ArmOutcome outcome = checked(stages, &check);
    if (outcome.status == OptimizerStatus::CANCELLED) throw Cancelled{};
    StageResult result = judged(check);
    const std::string folder = stages.path("design");
    result.files = filesOf(folder, "design");
    const bool whole = fs::exists(stages.path(ARM_BODY)) && fs::exists(stages.path(ARM_TABLE));
    if (!whole && !result.ends) {
      result.ends = true, result.verdict = Verdict::FAIL;
      result.words += "; no body could be traced";
    }
    return result;
  });
}

}  // namespace snapwing::pipeline
