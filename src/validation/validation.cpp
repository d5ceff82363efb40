#include "snapwing/validation/validation.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <nlohmann/json.hpp>
#include <sstream>

#include "snapwing/common/error.h"
#include "snapwing/common/parallel.h"
#include "snapwing/common/program_code.h"
#include "snapwing/common/provenance.h"
#include "snapwing/common/require.h"
#include "snapwing/planning/uncertainty_points.h"
#include "snapwing/validation/kept_results.h"

namespace snapwing::validation {

namespace {

using motion::TrialRung;
using vehicle::Mode;

Mode other(Mode mode) { return mode == Mode::FIXED_WING ? Mode::QUADROTOR : Mode::FIXED_WING; }

/// The trials of all plans, in the order in which they run: the longest first.
class TrialList {
 public:
  TrialList(const vehicle::Vehicle& vehicle, const ValidationSettings& settings, const planning::PulsePlanner& planner,
            const std::vector<PlanFile>& plans)
      : vehicle_(vehicle), settings_(settings), planner_(planner), plans_(plans) {
    for (std::size_t k = 0; k < plans_.size(); ++k) {
      plan_ = static_cast<int>(k);
      add(TrialRole::THRESHOLD, TrialRung::PLANAR);
      add(TrialRole::THRESHOLD, TrialRung::LUMPED);
      if (settings_.volumetric) addSolids();
    }
    for (std::size_t k = 0; k < plans_.size(); ++k) {
      plan_ = static_cast<int>(k);
      add(TrialRole::HALF_STEP, TrialRung::PLANAR);
      add(TrialRole::NOMINAL, TrialRung::PLANAR);
      add(TrialRole::NOMINAL, TrialRung::LUMPED);
      addWeakest();
      addSamples();
    }
  }
  /// What F carries on soft arms, as the accident of that name has it by the tables.
  void addCarried() {
    ValidationTrial t;
    t.plan = -1;
    t.role = TrialRole::CARRIED;
    t.name = "held_upright_planar";
    t.trial.rung = TrialRung::PLANAR;
    t.trial.cell_size = settings_.planar_cell;
    t.trial.trial.mount = vehicle::Mount::HELD;
    t.trial.trial.gravity = 9.81;
    trials_.push_back(std::move(t));
  }
  std::vector<ValidationTrial> take() { return std::move(trials_); }

 private:
  const PlanFile& plan() const { return plans_[static_cast<std::size_t>(plan_)]; }

  void add(TrialRole role, TrialRung rung, const std::string& which = {}, const std::vector<double>& point = {}) {
    ValidationTrial t;
    t.plan = plan_;
    t.role = role;
    t.name = plan().word() + "_" + motion::rungName(rung) + (which.empty() ? "" : "_" + which);
    if (role == TrialRole::THRESHOLD) t.name += "_shortest_pulse";
    if (role == TrialRole::HALF_STEP) t.name += "_half_step";
    if (role == TrialRole::CURVE) t.name += "_curve";
    if (role == TrialRole::LIMIT) t.name += "_limit_curve";
    t.trial.rung = rung;
    t.trial.start = plan().start;
    t.trial.trial = plan().trial;
    t.trial.pulse = plan().pulse;
    t.trial.cell_size = rung == TrialRung::VOLUMETRIC ? settings_.solid_cell : settings_.planar_cell;
    t.trial.step = role == TrialRole::HALF_STEP ? settings_.step / 2 : settings_.step;
    if (!point.empty()) {
      t.trial.box.assign(point.begin(), point.end() - 1);
      t.trial.pulse = planning::receivedPulse(plan().pulse, planner_.settings(), vehicle_.radio, point.back());
    }
    trials_.push_back(std::move(t));
  }
  /// The solid in time with both kernels, and the static curves that its limit of small cells is found with.
  void addSolids() {
    for (const bool finer : {true, false}) {
      for (const scene::SceneKernel kernel : {scene::SceneKernel::LINEAR, scene::SceneKernel::LINEAR_REDUCED}) {
        addCurve(TrialRole::CURVE, TrialRung::VOLUMETRIC, settings_.solid_cell, finer);
        setKernel(kernel);
      }
      addCurve(TrialRole::CURVE, TrialRung::PLANAR, settings_.solid_cell, finer);
      addCurve(TrialRole::LIMIT, TrialRung::PLANAR, settings_.planar_cell / 2, finer);
    }
    for (const scene::SceneKernel kernel : {scene::SceneKernel::LINEAR, scene::SceneKernel::LINEAR_REDUCED}) {
      add(TrialRole::NOMINAL, TrialRung::VOLUMETRIC);
      setKernel(kernel);
    }
  }
  /// @param cell  [m] the larger of both sizes
  void addCurve(TrialRole role, TrialRung rung, double cell, bool finer) {
    add(role, rung);
    ValidationTrial& t = trials_.back();
    t.trial.on_curve = true;
    t.trial.cell_size = finer ? cell / 2 : cell;
    t.finer = finer;
    if (finer) t.name += "_fine";
  }
  void setKernel(scene::SceneKernel kernel) {
    trials_.back().trial.kernel = kernel;
    if (kernel != scene::SceneKernel::LINEAR) trials_.back().name += "_reduced";
  }
  /// A vehicle of the box: in the plane, and lumped beside it.
  void addVehicle(TrialRole role, const std::string& which, const std::vector<double>& point) {
    add(role, TrialRung::PLANAR, which, point);
    add(role, TrialRung::LUMPED, which, point);
  }
  void addWeakest() {
    if (settings_.weakest == 0) return;
    int number = 0;
    for (const auto& v : planner_.weakest(plan().start, plan().pulse, plan().trial, settings_.weakest)) {
      addVehicle(TrialRole::WEAKEST, "weakest_" + std::to_string(++number), v.coordinates);
    }
  }
  void addSamples() {
    if (settings_.samples == 0) return;
    const int dimension = static_cast<int>(planning::plannerCoordinateNames().size());
    int number = 0;
    for (const auto& point : planning::sobolPoints(dimension, settings_.samples, settings_.first_sample)) {
      addVehicle(TrialRole::SAMPLE, "sample_" + std::to_string(++number), point);
    }
  }

  const vehicle::Vehicle& vehicle_;
  const ValidationSettings& settings_;
  const planning::PulsePlanner& planner_;
  const std::vector<PlanFile>& plans_;
  int plan_ = 0;
  std::vector<ValidationTrial> trials_;
};

/// All that an outcome depends on, as a hash.
std::string keyOf(const ValidationTrial& t, const std::string& inputs) {
  std::ostringstream text;
  text.precision(17);
  const RungTrial& r = t.trial;
  text << inputs << ';' << static_cast<int>(r.rung) << ';' << static_cast<int>(r.start) << ';' << r.pulse.throttle
       << ';' << r.pulse.duration << ';' << r.pulse.hold_throttle << ';' << r.pulse.hold_duration << ';'
       << static_cast<int>(r.kernel) << ';' << r.cell_size << ';' << r.step << ';' << static_cast<int>(t.role) << ';'
       << vehicle::mountName(r.trial.mount) << ';' << vehicle::wingsName(r.trial.wings) << ';' << r.trial.gravity << ';'
       << r.trial.initial_speed << ';' << r.trial.push << ';' << r.trial.horizon << ';'
       << r.trial.initial_thrust_fraction.value_or(-1) << ';' << r.trial.final_thrust_fraction.value_or(-1) << ';'
       << r.near << ';' << r.on_curve;
  for (const double x : r.box) text << ';' << x;
  return common::sha256(text.str());
}

std::vector<PlanFile> planBoth(const vehicle::Vehicle& vehicle, const planning::PulsePlanner& planner,
                               std::vector<Check>* checks) {
  std::vector<PlanFile> plans;
  for (const Mode start : {Mode::FIXED_WING, Mode::QUADROTOR}) {
    PlanFile plan;
    plan.start = start;
    plan.trial.mount = vehicle::mountFor(vehicle, "auto", "validate");
    const planning::TransitionPlan found = planner.plan(start, other(start), plan.trial);
    plan.pulse = found.pulse;
    plan.worst_margin = found.worst_margin;
    checks->push_back(yesOrNo(plan.name() + ": a plan", found.accepted,
                              found.accepted ? "found by the planner with its defaults" : found.reason));
    if (found.accepted) plans.push_back(plan);
  }
  return plans;
}

std::vector<Check> checkOrigin(const std::vector<PlanFile>& plans, const vehicle::Vehicle& vehicle,
                               const std::string& table_sha256) {
  std::vector<Check> checks;
  for (const PlanFile& plan : plans) {
    if (plan.file.empty()) continue;
    const bool own = plan.vehicle_sha256 == vehicle.sha256, same_table = plan.table_sha256 == table_sha256;
    std::string words = own && same_table ? "hashes are equal" : own ? "" : "it was planned for another vehicle file";
    if (!same_table) words += std::string(words.empty() ? "" : "; ") + "it was planned on another force table";
    checks.push_back(yesOrNo(plan.name() + ": plan of this vehicle and table", own && same_table, words));
  }
  return checks;
}

/// On cells of half the size: the nominal vehicle and its shortest pulse, and what did not switch on the coarser ones.
/// @param trials  that have run; @param carried  what F carries gates, so that it needs an error bar
std::vector<ValidationTrial> finerTwins(const std::vector<ValidationTrial>& trials, bool carried) {
  std::vector<ValidationTrial> twins;
  for (const ValidationTrial& t : trials) {
    if (t.trial.rung != TrialRung::PLANAR || t.role == TrialRole::HALF_STEP || t.trial.on_curve) continue;
    if (t.role == TrialRole::CARRIED && !carried) continue;
    const bool search = t.role == TrialRole::THRESHOLD || t.role == TrialRole::CARRIED;
    if (search ? !std::isfinite(t.outcome.threshold) : t.role != TrialRole::NOMINAL && t.outcome.snapped) continue;
    ValidationTrial& twin = twins.emplace_back(t);
    twin.name += "_fine";
    twin.finer = true;
    twin.outcome = RungOutcome{};
    twin.trial.cell_size /= 2;
    if (search) twin.trial.near = t.outcome.threshold;
  }
  return twins;
}

/// Accidents that a switch may meet, by the tables.
void addFaults(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table,
               const std::optional<vehicle::WingTable>& wing, Validation* found) {
  std::vector<planning::AskedSwitch> switches;
  for (const PlanFile& plan : found->plans) switches.push_back({plan.start, plan.pulse, plan.trial});
  const std::vector<planning::AccidentMargin> faults = planning::faultMargins(vehicle, table, wing, switches);
  found->accidents.insert(found->accidents.end(), faults.begin(), faults.end());
}

const char HERE = 0;  // in this library: its code, and that of what it links, is the program of kept trials

/// Runs all trials, or takes what an earlier run has left.
class TrialRuns {
 public:
  TrialRuns(const RungRunner& runner, const ValidationHooks& hooks, const std::string& inputs)
      : runner_(runner), hooks_(hooks), inputs_(inputs) {
    if (!hooks.folder.empty()) kept_.emplace(hooks.folder, common::programOf(&HERE));
  }
  void run(std::vector<ValidationTrial>& trials, int threads) {
    const int count = static_cast<int>(trials.size());
    all_ = done_ + count;
    common::parallelFor(count, threads, [&](int k) { one(trials[static_cast<std::size_t>(k)]); });
  }

 private:
  bool cancelled() const { return hooks_.cancelled && hooks_.cancelled(); }
  bool known(ValidationTrial& t, const std::string& key) {
    if (!kept_) return false;
    const std::optional<nlohmann::ordered_json> kept = kept_->load(t.name, key);
    if (kept) return readOutcome(*kept, &t.outcome);
    const std::string other = kept_->otherProgram(t.name, key);
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!other.empty() && !told_ && hooks_.note) hooks_.note(hooks_.folder + ": " + other + "; computed anew");
    told_ = told_ || !other.empty();
    return false;
  }
  void one(ValidationTrial& t) {
    if (cancelled()) return;
    const std::string key = keyOf(t, inputs_);
    if (!known(t, key)) {
      t.outcome = t.role == TrialRole::THRESHOLD ? runner_.shortest(t.trial)
                  : t.role == TrialRole::CARRIED ? runner_.carried(t.trial)
                                                 : runner_.run(t.trial);
      if (cancelled()) return;
      if (kept_) kept_->save(t.name, key, keptOutcome(t.outcome));
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    if (hooks_.progress) hooks_.progress(++done_, all_, t.name);
  }
  const RungRunner& runner_;
  const ValidationHooks& hooks_;
  std::string inputs_;
  std::optional<KeptResults> kept_;
  std::mutex mutex_;
  int done_ = 0, all_ = 0;
  bool told_ = false;  ///< that another program's results are not taken
};

}  // namespace

void ValidationSettings::validate() const {
  const common::Require require("validation");
  require.within("planar_cell", planar_cell, 1e-4, 0.02);
  require.within("solid_cell", solid_cell, 1e-4, 0.02);
  require.within("weakest", weakest, 0, 500);
  require.within("samples", samples, 0, 10000);
  require.within("step", step, 1e-5, 0.02);
  require.within("threads", threads, 1, 256);
}

Validation validate(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table,
                    const std::optional<vehicle::WingTable>& wing, std::vector<PlanFile> plans,
                    const ValidationSettings& settings, const ValidationHooks& hooks) {
  settings.validate();
  Validation found;
  const auto add = [&](const std::vector<Check>& more) {
    found.checks.insert(found.checks.end(), more.begin(), more.end());
  };
  const bool winged = wing.has_value();
  found.accidents = planning::accidentMargins(vehicle, table, winged ? wing : std::nullopt);
  const planning::PulsePlanner planner(vehicle, table, {}, wing);
  if (plans.empty()) {
    plans = planBoth(vehicle, planner, &found.checks);
  } else {
    add(checkOrigin(plans, vehicle, common::sha256OfFile(vehicle.arm.table_file)));
  }
  found.plans = plans;
  addFaults(vehicle, table, winged ? wing : std::nullopt, &found);
  const std::vector<Check> accidents = checkAccidents(found.accidents, vehicle);
  const std::string body = settings.body.empty() ? vehicle.arm.density_file : settings.body;
  if (hooks.progress) hooks.progress(0, 0, "static curve");
  found.curves.push_back(traceArm(vehicle, body, settings.planar_cell, hooks.cancelled));
  if (settings.extrapolate) found.curves.push_back(traceArm(vehicle, body, settings.planar_cell / 2, hooks.cancelled));
  add(checkCurve(found.curves, table, vehicle));
  TrialList list(vehicle, settings, planner, found.plans);
  list.addCarried();
  found.trials = list.take();
  const RungRunner runner(vehicle, table, wing, settings.body, hooks.cancelled);
  const std::string inputs = vehicle.sha256 + common::sha256OfFile(vehicle.arm.table_file) + common::sha256OfFile(body);
  TrialRuns runs(runner, hooks, inputs);
  runs.run(found.trials, settings.threads);
  if (settings.extrapolate && !(hooks.cancelled && hooks.cancelled())) {
    std::vector<ValidationTrial> twins = finerTwins(found.trials, mustSurvive(vehicle, HELD_UPRIGHT));
    runs.run(twins, settings.threads);
    found.trials.insert(found.trials.end(), twins.begin(), twins.end());
  }
  found.cancelled = hooks.cancelled && hooks.cancelled();
  if (found.cancelled) return found;
  add(checkTrials(found, vehicle));
  add(accidents);
  add(checkCarried(found, vehicle));
  return found;
}

}  // namespace snapwing::validation
