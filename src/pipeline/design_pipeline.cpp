#include "snapwing/pipeline/design_pipeline.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "arm_stages.h"
#include "snapwing/common/error.h"
#include "snapwing/common/program_code.h"
#include "snapwing/common/provenance.h"
#include "snapwing/design/wing/wing_outcome.h"
#include "snapwing/pipeline/validate_vehicle.h"
#include "snapwing/planning/pulse_planner.h"
#include "snapwing/validation/plan_file.h"
#include "snapwing/vehicle/table_origin.h"
#include "snapwing/vehicle/vehicle_text.h"

namespace snapwing::pipeline {

namespace {

using validation::Verdict;
using vehicle::Mode;
namespace fs = std::filesystem;

constexpr char WING_FILE[] = "wing/wing.yaml", WING_TABLE[] = "wing/wing_table.h5", VEHICLE_FILE[] = "vehicle.yaml",
               VALIDATION[] = "validation/validation.json", REPORT[] = "validation/report.html";

const char HERE = 0;  // in this library, which stands on all that plans and validates

std::string planName(Mode start) { return start == Mode::FIXED_WING ? "plan_f_to_q.json" : "plan_q_to_f.json"; }

class DesignPipeline {
 public:
  DesignPipeline(const DesignPipelineSettings& settings, const DesignPipelineHooks& hooks)
      : settings_(settings),
        hooks_(hooks),
        vehicle_(vehicle::loadVehicle(settings.vehicle_file)),
        arm_(settings, hooks),
        winged_(!settings.wing_settings.empty() || vehicle_.hasWing()) {
    settings_.validation.validate();
    if (!settings_.wing_settings.empty()) wing_ = design::loadWingSettings(settings_.wing_settings);
    if (!wing_ && winged_) layout_ = design::loadWing(vehicle_.wing.layout_file);
    stages_ = std::make_unique<Stages>(settings_.folder, arm_.count() + (winged_ ? 1 : 0) + 4, hooks_.progress);
  }

  DesignPipelineResult run() {
    try {
      all();
    } catch (const Cancelled&) {
      result_.cancelled = true;
    }
    return result_;
  }

 private:
  /// True if the next stage may follow.
  bool follow(const StageResult& stage) {
    result_.stages.push_back(stage);
    if (hooks_.cancelled && hooks_.cancelled()) throw Cancelled{};
    return !stage.ends;
  }
  StageResult stage(const std::string& name, const Inputs& inputs, const std::function<StageResult()>& work) {
    return stages_->run(name, inputs, [&](bool) { return work(); });
  }
  std::string path(const std::string& file) const { return stages_->path(file); }
  std::string hash(const std::string& file) const { return common::sha256OfFile(path(file)); }

  void all() {
    if (arm_.optimises() && !follow(arm_.optimise(*stages_))) return;
    if (!follow(arm_.check(*stages_))) return;
    if (winged_ && !follow(wing())) return;
    follow(vehicleFile());
    result_.vehicle_file = path(VEHICLE_FILE);
    made_ = vehicle::loadVehicle(result_.vehicle_file);
    bool planned = true;
    for (const Mode start : {Mode::FIXED_WING, Mode::QUADROTOR}) planned = follow(plan(start)) && planned;
    if (planned && follow(validate())) result_.report_file = path(REPORT);
  }

  StageResult wing() {
    Inputs inputs = arm_.madeOf();
    inputs.emplace_back("arm's table", hash(ARM_TABLE));
    const std::string& file = wing_ ? settings_.wing_settings : vehicle_.wing.layout_file;
    inputs.emplace_back(wing_ ? "wing settings" : "wing's layout", common::sha256OfFile(file));
    return stage("wing", inputs, [&] { return wing_ ? designedWing() : sameWing(); });
  }

  /// The vehicle's own wing on the new arm.
  StageResult sameWing() {
    StageResult result;
    const auto motion = design::ArmMotion::fromTable(vehicle::loadForceTable(path(ARM_TABLE)), ARM_TABLE);
    common::makeFolder(path("wing"));
    try {
      design::saveWingTable(design::tabulateLayout(*layout_, motion), path(WING_TABLE));
    } catch (const common::Error& e) {
      result.verdict = Verdict::FAIL, result.ends = true;
      result.words = std::string("the vehicle's wing does not go with this arm: ") + e.what() +
                     "; --wing SETTINGS.yaml designs another one";
      return result;
    }
    common::writeFileAtomically(path(WING_FILE), common::readFile(vehicle_.wing.layout_file));
    result.words = "the vehicle's own, with a table for this arm";
    result.files = {WING_FILE, WING_TABLE};
    return result;
  }

  StageResult designedWing() {
    design::WingSettings settings = *wing_;
    settings.vehicle_file = settings_.vehicle_file;
    settings.motion = design::ArmMotion::fromTable(vehicle::loadForceTable(path(ARM_TABLE)), ARM_TABLE);
    design::WingJob job;
    job.folder = path("wing");
    job.rung = design::wingRungOf(settings.rung);
    job.cancelled = hooks_.cancelled;
    job.go_on = [this](const design::WingProgress& p) {
      stages_->working("local runs", static_cast<double>(p.run) / std::max(1, p.runs));
      return !(hooks_.cancelled && hooks_.cancelled());
    };
    const design::WingOutcome outcome = design::designWingInto(settings, job);
    if (outcome.design.status == design::WingStatus::CANCELLED) throw Cancelled{};
    StageResult result;
    result.words = std::string(design::nameOf(outcome.design.status)) + ": " + outcome.design.message;
    result.ends = outcome.design.status != design::WingStatus::DESIGNED;
    if (!result.ends) result.files = {WING_FILE, WING_TABLE};
    if (!result.ends && !outcome.stack.found) result.words += "; no layers: " + outcome.stack.message;
    if (!result.ends && !outcome.targets_met) result.words += "; targets NOT MET";
    const bool good = !result.ends && outcome.targets_met && outcome.stack.found;
    result.verdict = good ? Verdict::PASS : Verdict::FAIL;
    return result;
  }

  /// The vehicle's file with what is new; numbers, sources and comments stay.
  std::string vehicleText() const {
    std::string text = vehicle::withoutKeys(common::readFile(settings_.vehicle_file), {"results"});
    text = vehicle::withValue(text, "arm", "density_file", ARM_BODY);
    text = vehicle::withValue(text, "arm", "table_file", ARM_TABLE);
    if (winged_) {
      text = vehicle::withValue(text, "wing", "layout_file", WING_FILE);
      text = vehicle::withValue(text, "wing", "table_file", WING_TABLE);
    }
    return text + "\nresults:  # of this file; `snapwing validate` tries these plans\n  plan_f_to_q: " +
           planName(Mode::FIXED_WING) + "\n  plan_q_to_f: " + planName(Mode::QUADROTOR) +
           "\n  validation: " + VALIDATION + "\n";
  }

  StageResult vehicleFile() {
    const std::string text = vehicleText();
    const std::string noted = stages_->notedHash("vehicle file", VEHICLE_FILE);
    if (fs::exists(path(VEHICLE_FILE)) && hash(VEHICLE_FILE) != noted && hash(VEHICLE_FILE) != common::sha256(text)) {
      throw common::FileError(path(VEHICLE_FILE),
                              "was changed since it was made, and would be overwritten; put the change into " +
                                  settings_.vehicle_file + " and remove this one");
    }
    Inputs inputs = {
        {"vehicle file", vehicle_.sha256}, {"arm's body", hash(ARM_BODY)}, {"arm's table", hash(ARM_TABLE)}};
    if (winged_) inputs.emplace_back("wing's table", hash(WING_TABLE));
    return stage("vehicle file", inputs, [&] {
      common::writeFileAtomically(path(VEHICLE_FILE), text);
      requireOwn();
      StageResult result;
      result.words = path(VEHICLE_FILE);
      result.files = {VEHICLE_FILE};
      return result;
    });
  }

  /// What was written names what was made, and goes together.
  void requireOwn() const {
    const vehicle::Vehicle made = vehicle::loadVehicle(path(VEHICLE_FILE));
    const auto require = [&](const char* key, const std::string& named, const char* file) {
      if (fs::exists(named) && fs::equivalent(named, path(file))) return;
      throw common::SettingError(settings_.vehicle_file, key, "not on a line of its own",
                                 "`key: value` on a line of its own below its section, so that it can be replaced");
    };
    require("arm.density_file", made.arm.density_file, ARM_BODY);
    require("arm.table_file", made.arm.table_file, ARM_TABLE);
    if (winged_) {
      require("wing.layout_file", made.wing.layout_file, WING_FILE);
      require("wing.table_file", made.wing.table_file, WING_TABLE);
    }
    vehicle::wingTableOf(made, vehicle::armTableOf(made));
  }

  Inputs ofVehicle() const {
    Inputs inputs = {{"program", common::programOf(&HERE)},
                     {"vehicle file", made_.sha256},
                     {"arm's body", hash(ARM_BODY)},
                     {"arm's table", hash(ARM_TABLE)}};
    if (winged_) inputs.emplace_back("wing's table", hash(WING_TABLE));
    return inputs;
  }

  StageResult plan(Mode start) {
    const std::string name = start == Mode::FIXED_WING ? "plan F -> Q" : "plan Q -> F";
    return stage(name, ofVehicle(), [&] {
      const vehicle::ForceTable table = vehicle::armTableOf(made_);
      const planning::PulsePlanner planner(made_, table, {}, vehicle::wingTableOf(made_, table));
      vehicle::Trial trial;
      trial.mount = vehicle::mountFor(made_, "auto", "design");
      const planning::TransitionPlan found = planner.plan(start, trial);
      validation::savePlan(path(planName(start)), made_, made_.arm.table_file, trial, found);
      StageResult result;
      char words[120];
      std::snprintf(words, sizeof words, "throttle %.3f for %.3f s, worst margin %+.3f", found.pulse.throttle,
                    found.pulse.duration, found.worst_margin);
      result.words = found.accepted ? words : "refused: " + found.reason;
      result.verdict = found.accepted ? Verdict::PASS : Verdict::FAIL;
      result.ends = !found.accepted;
      result.files = {planName(start)};
      return result;
    });
  }

  StageResult validate() {
    Inputs inputs = ofVehicle();
    for (const Mode start : {Mode::FIXED_WING, Mode::QUADROTOR}) {
      inputs.emplace_back(planName(start), hash(planName(start)));
    }
    inputs.emplace_back("validation's options", settingsText(settings_.validation));
    return stage("validation", inputs, [&] {
      ValidateJob job;
      job.vehicle_file = path(VEHICLE_FILE);
      job.folder = path("validation");
      job.settings = settings_.validation;
      if (settings_.threads > 0) job.settings.threads = settings_.threads;
      job.command = "snapwing design arm --into " + settings_.folder;
      job.cancelled = hooks_.cancelled;
      job.note = hooks_.warning;
      job.progress = [this](int done, int all, const std::string& what) {
        stages_->working(what, all > 0 ? static_cast<double>(done) / all : std::nan(""));
      };
      const VehicleValidation answer = validateVehicle(job);
      if (answer.found.cancelled) throw Cancelled{};
      StageResult result;
      result.verdict = validation::verdictOf(answer.found.checks);
      result.files = {VALIDATION, REPORT};
      for (const validation::Check& c : answer.found.checks) {
        if (c.verdict != Verdict::FAIL && c.verdict != Verdict::UNDECIDED) continue;
        result.words += (result.words.empty() ? "" : "\n") + validation::verdictName(c.verdict) + "  " + checkLine(c);
      }
      return result;
    });
  }

  DesignPipelineSettings settings_;
  const DesignPipelineHooks& hooks_;
  vehicle::Vehicle vehicle_;  ///< as it was given
  ArmStages arm_;
  bool winged_;
  std::optional<design::WingSettings> wing_;  ///< of a new wing
  std::optional<design::WingLayout> layout_;  ///< of the vehicle's own
  std::unique_ptr<Stages> stages_;
  vehicle::Vehicle made_;  ///< as it is written
  DesignPipelineResult result_;
};

}  // namespace

Verdict DesignPipelineResult::verdict() const {
  const auto has = [this](Verdict verdict) {
    return std::any_of(stages.begin(), stages.end(), [&](const StageResult& s) { return s.verdict == verdict; });
  };
  if (has(Verdict::FAIL) || report_file.empty()) return Verdict::FAIL;
  return has(Verdict::UNDECIDED) ? Verdict::UNDECIDED : Verdict::PASS;
}

DesignPipelineResult designPipeline(const DesignPipelineSettings& settings, const DesignPipelineHooks& hooks) {
  return DesignPipeline(settings, hooks).run();
}

std::string armSettingsBeside(const std::string& vehicle_file) {
  const std::string path = (fs::path(vehicle_file).parent_path() / "arm_design.yaml").string();
  if (fs::is_regular_file(path)) return path;
  throw common::FileError(path,
                          "is not there: settings of the arm's design; `snapwing vehicle new` makes them beside a "
                          "vehicle file, or name others");
}

}  // namespace snapwing::pipeline
