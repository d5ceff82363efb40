#include "snapwing/design/arm_run.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <sstream>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"
#include "snapwing/design/arm_topology.h"
#include "snapwing/design/array_file.h"

namespace snapwing::design {

namespace {

constexpr int FRAME_EVERY = 10;  ///< iterations between pictures of the film strip

OptimizerSettings optimizerSettings(const ArmDesignSettings& s) {
  OptimizerSettings o;
  o.iterations = s.iterations;
  o.move = s.move;
  o.conservative = s.optimizer == "gcmma";
  o.tolerance = 1e-3;
  o.feasibility = 0.02;  // of a force bound
  o.least_iterations = static_cast<int>(std::ceil(std::max(s.sharpness_to, s.volume_until) * s.iterations));
  return o;
}

std::unique_ptr<Optimizer> optimizerFor(const ArmDesignSettings& s, const OptimizerSettings& o) {
  return s.optimizer == "nlopt" ? makeNloptMma(o) : makeMma(o);
}

void saveCheckpoint(const ArmDesignSettings& settings, const OptimizerState& state, const std::string& path) {
  ArrayFile file;
  file.arrays = {
      {"x", state.x},     {"x_old", state.x_old}, {"x_older", state.x_older},
      {"low", state.low}, {"high", state.high},   {"iteration", Eigen::VectorXd::Constant(1, state.iteration)}};
  file.notes["inputs_sha256"] = settings.hash();
  saveArrays(file, path);
}

OptimizerState loadCheckpoint(const ArmDesignSettings& settings, const std::string& path) {
  const ArrayFile file = loadArrays(path);
  const auto hash = file.notes.find("inputs_sha256");
  if (hash == file.notes.end() || hash->second != settings.hash()) {
    throw common::FileError(path, "belongs to other inputs: settings or vehicle have changed");
  }
  const auto get = [&](const char* name) {
    const auto found = file.arrays.find(name);
    if (found == file.arrays.end()) throw common::FileError(path, std::string("lacks ") + name);
    return found->second;
  };
  OptimizerState state;
  state.x = get("x"), state.x_old = get("x_old"), state.x_older = get("x_older");
  state.low = get("low"), state.high = get("high");
  state.iteration = static_cast<int>(get("iteration")(0));
  return state;
}

void saveHistory(const ArmDesignSettings& settings, const ArmRun& run, ArrayFile frames, const std::string& folder) {
  std::ostringstream csv;
  csv << "# forces of one arm\niteration,objective,violation,change,volume,volume_bound,grey,sharpness,seconds";
  for (const double u : run.travels) csv << ",R_at_" << std::lround(1e6 * u) << "_um_N";
  csv << "\n";
  const int rows = static_cast<int>(run.history.size());
  Eigen::VectorXd objective(rows), violation(rows), volume(rows), grey(rows);
  for (int k = 0; k < rows; ++k) {
    const ArmProgress& h = run.history[k];
    csv << h.report.iteration << "," << h.report.objective << "," << h.report.violation << "," << h.report.change << ","
        << h.volume << "," << h.volume_bound << "," << h.grey << "," << h.sharpness << "," << h.report.seconds;
    for (const double f : h.forces) csv << "," << f;
    csv << "\n";
    objective(k) = h.report.objective, violation(k) = h.report.violation, volume(k) = h.volume, grey(k) = h.grey;
  }
  common::writeFileAtomically(folder + "/history.csv", csv.str());
  frames.arrays["objective"] = objective, frames.arrays["violation"] = violation;
  frames.arrays["volume"] = volume, frames.arrays["grey"] = grey;
  frames.arrays["cells"] = Eigen::Vector2d(run.field.cells[0], run.field.cells[1]);
  frames.notes["inputs_sha256"] = settings.hash();
  frames.notes["snapwing_version"] = common::version();
  saveArrays(frames, folder + "/history.h5");
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

ArmRun runArmDesign(const ArmDesignSettings& settings, const ArmRunOptions& options) {
  ArmTopology problem(settings);
  ArmRun run;
  run.travels = problem.travels();
  OptimizerState start;
  start.x = problem.start();
  const std::string checkpoint = options.folder + "/checkpoint.h5";
  if (!options.folder.empty()) std::filesystem::create_directories(options.folder);
  if (options.resume && std::filesystem::exists(checkpoint)) start = loadCheckpoint(settings, checkpoint);
  ArrayFile frames;
  OptimizerSettings o = optimizerSettings(settings);
  o.progress = [&](const OptimizerReport& report, const OptimizerState& state) {
    ArmProgress p;
    p.report = report;
    p.volume = problem.lastVolume(), p.volume_bound = problem.volumeBound();
    p.grey = problem.lastGrey(), p.sharpness = problem.sharpness();
    p.forces = problem.lastForces();
    run.history.push_back(p);
    if (report.iteration % FRAME_EVERY == 0) {
      char name[32];
      std::snprintf(name, sizeof name, "frame_%04d", report.iteration);
      const auto& value = problem.field(state.x).value;
      frames.arrays[name] = Eigen::Map<const Eigen::VectorXd>(value.data(), static_cast<Eigen::Index>(value.size()));
    }
    const bool stop = options.progress && options.progress(p);
    if (!options.folder.empty() && (stop || report.iteration % options.checkpoint_every == 0)) {
      saveCheckpoint(settings, state, checkpoint);
    }
    return stop;
  };
  run.result = optimizerFor(settings, o)->run(problem, start);
  run.field = problem.field(run.result.state.x);
  run.forces = problem.lastForces();
  run.volume = problem.lastVolume(), run.grey = problem.lastGrey(), run.retraces = problem.retraces();
  if (!options.folder.empty()) {
    saveCheckpoint(settings, run.result.state, checkpoint);
    saveHistory(settings, run, frames, options.folder);
  }
  return run;
}

double GradientRow::best() const { return *std::min_element(relative_errors.begin(), relative_errors.end()); }

double GradientCheck::worst() const {
  double result = 0;
  for (const GradientRow& row : rows) result = std::max(result, row.best());
  return result;
}

GradientCheck checkArmGradients(const ArmDesignSettings& settings, double sharpness_share) {
  GradientCheck check;
  check.steps = {1e-2, 1e-3, 1e-4, 1e-5};
  ArmTopology problem(settings, 1e-12);  // tight: differences of solutions must not show the solver's tolerance
  problem.beginIteration(static_cast<int>(1000 * sharpness_share), 1001);
  Eigen::VectorXd x = problem.start(), direction = x;
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    x(k) = std::clamp(x(k) - 0.05 - 0.1 * std::sin(0.37 * static_cast<double>(k)), 0.02, 0.97);
    direction(k) = 0.5 + 0.5 * std::cos(0.11 * static_cast<double>(k) + 0.4);
  }
  const Evaluated at = problem.evaluate(x, true);
  check.valid = at.valid;
  check.message = at.message;
  if (!at.valid) return check;
  const Eigen::VectorXd slopes = at.jacobian * direction;
  for (Eigen::Index i = -1; i < slopes.size(); ++i) {
    check.rows.push_back(
        {i < 0 ? "objective" : "constraint " + std::to_string(i), i < 0 ? at.gradient.dot(direction) : slopes(i), {}});
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
      const double scale = std::max(std::abs(row.derivative), 1e-9);
      row.relative_errors.push_back(std::abs(rise / (2 * h) - row.derivative) / scale);
    }
  }
  return check;
}

}  // namespace snapwing::design
