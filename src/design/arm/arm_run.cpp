#include "snapwing/design/arm/arm_run.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <sstream>

#include "array_file.h"
#include "design_scene.h"
#include "snapwing/common/checkpoint_bytes.h"
#include "snapwing/common/elementary.h"
#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"
#include "snapwing/design/arm/arm_topology.h"
#include "snapwing/design/design_program.h"

namespace snapwing::design {

namespace {

constexpr int FRAME_EVERY = 10;  ///< iterations between pictures of the film strip

OptimizerSettings optimizerSettings(const ArmDesignSettings& s, int stage) {
  OptimizerSettings o;
  o.iterations = s.stages[stage].iterations;
  o.move = s.stages[stage].move;
  o.conservative = s.optimizer == "gcmma";
  o.tolerance = 1e-3;
  o.feasibility = 0.02;  // of a force bound
  // No stage but the last may end early: the continuation counts iterations.
  const bool last = stage + 1 == static_cast<int>(s.stages.size());
  const double until = std::max(s.sharpness_to, s.volume_until) * s.iterations();
  o.least_iterations =
      last ? std::max(0, static_cast<int>(std::ceil(until)) - (s.iterations() - o.iterations)) : o.iterations;
  return o;
}

std::unique_ptr<Optimizer> optimizerFor(const ArmDesignSettings& s, const OptimizerSettings& o) {
  return s.optimizer == "nlopt" ? makeNloptMma(o) : makeMma(o);
}

constexpr int NUMBERS = 10;  ///< of a history row, before the forces

Eigen::VectorXd packed(const std::vector<ArmProgress>& history, std::size_t forces) {
  Eigen::VectorXd rows(static_cast<Eigen::Index>(history.size() * (NUMBERS + forces)));
  Eigen::Index at = 0;
  for (const ArmProgress& p : history) {
    const OptimizerReport& r = p.report;
    for (const double x : {static_cast<double>(r.iteration), r.objective, r.violation, r.change, r.seconds,
                           static_cast<double>(p.stage), p.volume, p.volume_bound, p.grey, p.sharpness}) {
      rows(at++) = x;
    }
    for (std::size_t k = 0; k < forces; ++k) rows(at++) = p.forces[k];
  }
  return rows;
}

std::vector<ArmProgress> unpacked(const Eigen::VectorXd& rows, std::size_t forces) {
  std::vector<ArmProgress> history;
  for (Eigen::Index at = 0; at < rows.size();) {
    ArmProgress p;
    p.report.iteration = static_cast<int>(rows(at++));
    for (double* x : {&p.report.objective, &p.report.violation, &p.report.change, &p.report.seconds}) *x = rows(at++);
    p.stage = static_cast<int>(rows(at++));
    for (double* x : {&p.volume, &p.volume_bound, &p.grey, &p.sharpness}) *x = rows(at++);
    for (std::size_t k = 0; k < forces; ++k) p.forces.push_back(rows(at++));
    history.push_back(p);
  }
  return history;
}

/// One run with what is kept of it from stage to stage and from session to session.
class Runner {
 public:
  Runner(const ArmDesignSettings& settings, const ArmRunOptions& options) : settings_(settings), options_(options) {}
  ArmRun run();

 private:
  std::string checkpointFile() const { return options_.folder + "/checkpoint.h5"; }
  /// @return false for a checkpoint of another program
  bool loadCheckpoint();
  void saveCheckpoint(const ArmTopology& problem, const OptimizerState& state);
  void saveHistory() const;
  bool onIteration(const ArmTopology& problem, const OptimizerReport& report, const OptimizerState& state);
  void runStage();

  const ArmDesignSettings& settings_;
  const ArmRunOptions& options_;
  ArmRun run_;
  int stage_ = 0, before_ = 0;  ///< iterations of earlier stages
  double seconds_before_ = 0;
  bool warned_ = false;
  OptimizerState start_;
  std::map<std::string, Eigen::VectorXd> warm_, frames_;
  mpm::DensityField variables_;  ///< end of the stage before
};

void Runner::saveCheckpoint(const ArmTopology& problem, const OptimizerState& state) {
  ArrayFile file;
  file.arrays = problem.warmStates();
  file.arrays.insert(frames_.begin(), frames_.end());
  file.arrays["x"] = state.x, file.arrays["x_old"] = state.x_old, file.arrays["x_older"] = state.x_older;
  file.arrays["low"] = state.low, file.arrays["high"] = state.high, file.arrays["x_feasible"] = state.x_feasible;
  file.arrays["place"] = Eigen::Vector2d(stage_, state.iteration);
  file.arrays["history"] = packed(run_.history, run_.travels.size());
  file.notes["inputs_sha256"] = settings_.hash();
  file.notes["program"] = designProgram();
  try {
    saveArrays(file, checkpointFile());
  } catch (const common::FileError& e) {
    // The design does not depend on it.
    if (options_.warning && !warned_) options_.warning(std::string("no checkpoint: ") + e.what());
    warned_ = true;
  }
}

bool Runner::loadCheckpoint() {
  const ArrayFile file = loadArrays(checkpointFile());
  const auto hash = file.notes.find("inputs_sha256");
  if (hash == file.notes.end() || hash->second != settings_.hash()) {
    throw common::FileError(checkpointFile(), "belongs to other inputs: settings or vehicle have changed");
  }
  const auto wrote = file.notes.find("program");
  if (wrote == file.notes.end() || wrote->second != designProgram()) {
    const std::string name = wrote == file.notes.end() ? "an earlier one" : wrote->second;
    const common::OtherProgramError why(checkpointFile(), name, designProgram());
    if (options_.warning) options_.warning(std::string(why.what()) + "; begins anew");
    return false;
  }
  const auto get = [&](const char* name) {
    const auto found = file.arrays.find(name);
    if (found == file.arrays.end()) throw common::FileError(checkpointFile(), std::string("lacks ") + name);
    return found->second;
  };
  start_.x = get("x"), start_.x_old = get("x_old"), start_.x_older = get("x_older");
  start_.low = get("low"), start_.high = get("high"), start_.x_feasible = get("x_feasible");
  const Eigen::VectorXd place = get("place");
  stage_ = static_cast<int>(place(0));
  start_.iteration = static_cast<int>(place(1));
  if (stage_ < 0 || stage_ >= static_cast<int>(settings_.stages.size())) {
    throw common::FileError(checkpointFile(), "names a stage that the settings lack");
  }
  run_.history = unpacked(get("history"), run_.travels.size());
  // The iteration of the checkpoint is evaluated again.
  if (!run_.history.empty()) seconds_before_ = run_.history.back().report.seconds, run_.history.pop_back();
  for (const auto& [name, values] : file.arrays) {
    if (name.rfind("warm_", 0) == 0) warm_[name] = values;
    if (name.rfind("frame_", 0) == 0) frames_[name] = values;
  }
  return true;
}

bool Runner::onIteration(const ArmTopology& problem, const OptimizerReport& report, const OptimizerState& state) {
  ArmProgress p;
  p.report = report;
  p.report.iteration += before_;
  p.report.seconds += seconds_before_;
  p.stage = stage_;
  p.volume = problem.lastVolume(), p.volume_bound = problem.volumeBound();
  p.grey = problem.lastGrey(), p.sharpness = problem.sharpness();
  p.forces = problem.lastForces();
  run_.history.push_back(p);
  if (p.report.iteration % FRAME_EVERY == 0 || p.report.iteration + 1 >= settings_.iterations()) {
    char name[32];
    std::snprintf(name, sizeof name, "frame_%04d", p.report.iteration);
    const auto& value = problem.field(state.x).value;
    frames_[name] = Eigen::Map<const Eigen::VectorXd>(value.data(), static_cast<Eigen::Index>(value.size()));
  }
  const bool stop = options_.progress && options_.progress(p);
  if (!options_.folder.empty() && (stop || report.iteration % options_.checkpoint_every == 0)) {
    saveCheckpoint(problem, state);
  }
  return stop;
}

void Runner::runStage() {
  ArmTopology problem(settings_, stage_);
  if (!warm_.empty()) {
    problem.restoreWarmStates(warm_);
    warm_.clear();
  } else {
    start_ = OptimizerState();
    start_.x = stage_ == 0 ? problem.start() : problem.variablesFrom(variables_);
  }
  OptimizerSettings o = optimizerSettings(settings_, stage_);
  o.progress = [&](const OptimizerReport& report, const OptimizerState& state) {
    return onIteration(problem, report, state);
  };
  run_.result = optimizerFor(settings_, o)->run(problem, start_);
  seconds_before_ += run_.result.seconds;
  run_.seconds = seconds_before_;
  run_.evaluations += run_.result.evaluations;
  run_.retraces += problem.retraces();
  const Eigen::VectorXd& x = run_.result.state.x;
  variables_ = problem.variables(x);
  run_.field = problem.field(x);
  run_.forces = problem.lastForces();
  run_.volume = problem.lastVolume(), run_.mass = problem.lastMass(), run_.grey = problem.lastGrey();
  run_.worst.clear();
  if (!run_.result.history.empty() && run_.result.violation > o.feasibility) {
    Eigen::Index at = 0;
    run_.result.history.back().constraints.maxCoeff(&at);
    run_.worst = problem.constraintNames()[static_cast<std::size_t>(at)];
    run_.result.message += (run_.result.message.empty() ? "" : ": ") + run_.worst;
  }
  if (!options_.folder.empty()) saveCheckpoint(problem, run_.result.state);
}

void Runner::saveHistory() const {
  std::ostringstream csv;
  csv << "# forces of one arm\niteration,stage,objective,violation,change,volume,volume_bound,grey,sharpness,seconds";
  for (const double u : run_.travels) csv << ",R_at_" << std::lround(1e6 * u) << "_um_N";
  csv << "\n";
  const int rows = static_cast<int>(run_.history.size());
  Eigen::VectorXd objective(rows), violation(rows), volume(rows), grey(rows);
  for (int k = 0; k < rows; ++k) {
    const ArmProgress& h = run_.history[k];
    csv << h.report.iteration << "," << h.stage << "," << h.report.objective << "," << h.report.violation << ","
        << h.report.change << "," << h.volume << "," << h.volume_bound << "," << h.grey << "," << h.sharpness << ","
        << h.report.seconds;
    for (const double f : h.forces) csv << "," << f;
    csv << "\n";
    objective(k) = h.report.objective, violation(k) = h.report.violation, volume(k) = h.volume, grey(k) = h.grey;
  }
  common::writeFileAtomically(options_.folder + "/history.csv", csv.str());
  ArrayFile file;
  file.arrays = frames_;
  file.arrays["objective"] = objective, file.arrays["violation"] = violation;
  file.arrays["volume"] = volume, file.arrays["grey"] = grey;
  file.arrays["cells"] = Eigen::Vector2d(run_.field.cells[0], run_.field.cells[1]);
  file.notes["inputs_sha256"] = settings_.hash();
  file.notes["snapwing_version"] = common::version();
  saveArrays(file, options_.folder + "/history.h5");
}

ArmRun Runner::run() {
  const std::clock_t begin = std::clock();
  run_.travels = ArmTopology(settings_).travels();
  if (!options_.folder.empty()) common::makeFolder(options_.folder);
  if (options_.resume && std::filesystem::exists(checkpointFile())) loadCheckpoint();
  for (int stage = 0; stage < stage_; ++stage) before_ += settings_.stages[stage].iterations;
  for (const int count = static_cast<int>(settings_.stages.size());; ++stage_) {
    runStage();
    const OptimizerStatus status = run_.result.status;
    // A stage that ends with a bound violated may be mended by the next.
    if (status == OptimizerStatus::CANCELLED || status == OptimizerStatus::EVALUATION_FAILED) break;
    before_ += settings_.stages[stage_].iterations;
    if (stage_ + 1 >= count) break;
  }
  if (!options_.folder.empty()) saveHistory();
  run_.cpu_seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  return run_;
}

}  // namespace

void saveDensityCsv(const mpm::DensityField& field, const std::string& comment, const std::string& path) {
  std::string text = "# " + comment + "\ni,j,rho\n";
  char line[64];
  for (int j = 0; j < field.cells[1]; ++j) {
    for (int i = 0; i < field.cells[0]; ++i) {
      if (!field.present(i, j)) continue;
      std::snprintf(line, sizeof line, "%d,%d,%.4f\n", i, j, field.at(i, j));
      text += line;
    }
  }
  common::writeFileAtomically(path, text);
}

mpm::DensityField loadDesignedDensity(const ArmDesignSettings& s, const std::string& path) {
  const mpm::DensityField domain = designDomain(s, s.stages.front().cell_size, 0);
  return mpm::loadDensityCsv(path, domain.cells[0] * domain.cell_size, domain.cells[1] * domain.cell_size);
}

ArmRun runArmDesign(const ArmDesignSettings& settings, const ArmRunOptions& options) {
  return Runner(settings, options).run();
}

double GradientRow::best() const { return *std::min_element(relative_errors.begin(), relative_errors.end()); }

double GradientCheck::worst() const {
  double result = 0;
  for (const GradientRow& row : rows) result = std::max(result, row.best());
  return result;
}

GradientCheck checkArmGradients(const ArmDesignSettings& settings, double share, int stage) {
  GradientCheck check;
  check.steps = {1e-2, 1e-3, 1e-4, 1e-5};
  ArmTopology problem(settings, stage, 1e-12);  // tight: differences of solutions must not show the solver's tolerance
  problem.beginIteration(static_cast<int>(share * settings.stages[stage].iterations),
                         settings.stages[stage].iterations);
  const std::vector<std::string> names = problem.constraintNames();
  Eigen::VectorXd x = problem.start(), direction = x;
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    x(k) = std::clamp(x(k) - 0.05 - 0.1 * common::sin(0.37 * static_cast<double>(k)), 0.02, 0.97);
    direction(k) = 0.5 + 0.5 * common::cos(0.11 * static_cast<double>(k) + 0.4);
  }
  const Evaluated at = problem.evaluate(x, true);
  check.valid = at.valid;
  check.message = at.message;
  if (!at.valid) return check;
  const Eigen::VectorXd slopes = at.jacobian * direction, size = direction.cwiseAbs();
  // Errors are measured against the sum of the cells' parts without their signs: the parts may cancel.
  Eigen::VectorXd scales(slopes.size() + 1);
  scales << at.gradient.cwiseAbs().dot(size), at.jacobian.cwiseAbs() * size;
  for (Eigen::Index i = -1; i < slopes.size(); ++i) {
    check.rows.push_back(
        {i < 0 ? "objective" : names[static_cast<std::size_t>(i)], i < 0 ? at.gradient.dot(direction) : slopes(i), {}});
  }
  for (const double h : check.steps) {
    const Evaluated up = problem.evaluate(x + h * direction, false), down = problem.evaluate(x - h * direction, false);
    if (!up.valid || !down.valid) {
      check.valid = false;
      check.message = up.valid ? down.message : up.message;
      return check;
    }
    for (Eigen::Index i = -1; i < slopes.size(); ++i) {
      GradientRow& row = check.rows[static_cast<std::size_t>(i + 1)];
      const double rise = i < 0 ? up.objective - down.objective : up.constraints(i) - down.constraints(i);
      row.relative_errors.push_back(std::abs(rise / (2 * h) - row.derivative) / std::max(scales(i + 1), 1e-9));
    }
  }
  return check;
}

}  // namespace snapwing::design
