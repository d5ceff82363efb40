// `snapwing curve`: traces the force-displacement curve of a vehicle's arm, or of any scene, with units and provenance.
#include <CLI/CLI.hpp>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "commands.h"
#include "snapwing/common/error.h"
#include "snapwing/common/force_table.h"
#include "snapwing/common/provenance.h"
#include "snapwing/common/vehicle.h"
#include "snapwing/statics/arm_problem.h"
#include "snapwing/statics/scene_curve.h"

namespace snapwing::tools {

namespace {

struct CurveOptions {
  std::string input, output, csv, summary, plane = "stress", kernel, vtu;
  double cell_size = 0, step = 0.001, from = NAN, to = NAN;
  bool no_back = false, quiet = false, arc_length = false;
  int threads = 1, particles = 0, steps = 0;
};

volatile std::sig_atomic_t interrupted = 0;
void onInterrupt(int) { interrupted = 1; }

std::string toText(double value) {
  std::ostringstream text;
  text.precision(10);
  text << value;
  return text.str();
}

bool showProgress(const CurveOptions& options, double share, double travel) {
  if (!options.quiet) {
    std::fprintf(stderr, "\r%3.0f %%  at %10.5g ", 100 * share, travel);
    if (share >= 1) std::fprintf(stderr, "\n");
    std::fflush(stderr);
  }
  return interrupted != 0;
}

std::string armInputs(const common::Vehicle& vehicle) {
  const common::ArmSettings& a = vehicle.arm;
  std::ostringstream text;
  text.precision(17);
  for (const double value :
       {a.domain_length, a.domain_height, a.leg_width, a.bar_height, a.leg_thickness, a.bar_thickness, a.pin_x, a.pin_y,
        a.clamp_y_low, a.clamp_y_high, vehicle.material.youngs_modulus.value, vehicle.material.poisson_ratio.value}) {
    text << value << ";";
  }
  return text.str();
}

void describe(const CurveOptions& options, const common::Vehicle& vehicle, const statics::ArmProblem& arm,
              common::ForceTable& table) {
  table.arm_count = vehicle.arm.count;
  // The hash covers what the curve depends on in the vehicle file, and the design: other settings may change freely.
  const std::string density = common::readFile(vehicle.arm.density_file);
  auto& p = table.provenance;
  p["rung"] = "planar";
  p["plane"] = options.plane;
  p["kernel"] = "linear";
  p["cell_size_m"] = toText(arm.field().cell_size);
  p["step_m"] = toText(options.step);
  p["dof"] = std::to_string(arm.problem().freeCount());
  p["vehicle"] = vehicle.name;
  p["youngs_modulus_pa"] = toText(vehicle.material.youngs_modulus.value);
  p["poisson_ratio"] = toText(vehicle.material.poisson_ratio.value);
  p["vehicle_sha256"] = vehicle.sha256;
  p["density_sha256"] = common::sha256(density);
  p["inputs_sha256"] = common::sha256(armInputs(vehicle) + density);
  p["snapwing_version"] = common::version();
  p["command"] = "snapwing curve, plane " + options.plane + ", from " + toText(table.travel.front()) + " m to " +
                 toText(table.travel.back()) + " m";
}

void writeCsv(const std::string& path, const common::ForceTable& table) {
  std::ostringstream text;
  text.precision(12);
  text << "# one arm; force and energy of the vehicle: times " << table.arm_count << "\n"
       << "travel_m,force_N,stiffness_N_per_m,energy_J,rotation_rad,stable,min_det_f,iterations"
       << (table.force_back.empty() ? "" : ",force_back_N") << "\n";
  for (std::size_t k = 0; k < table.travel.size(); ++k) {
    text << table.travel[k] << "," << table.force[k] << "," << table.stiffness[k] << "," << table.energy[k] << ","
         << table.rotation[k] << "," << table.stable[k] << "," << table.min_det_f[k] << "," << table.iterations[k];
    if (!table.force_back.empty()) text << "," << table.force_back[k];
    text << "\n";
  }
  common::writeFileAtomically(path, text.str());
}

nlohmann::json orNull(double value) { return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr); }

void addFeatures(const common::ForceTable& table, nlohmann::json& j) {
  if (table.travel.size() >= 4) {
    const common::CurveFeatures f = common::curveFeatures(table);
    j["peak"] = {{"travel_m", orNull(f.peak_travel)}, {"force_N", orNull(f.peak_force)}};
    j["valley"] = {{"travel_m", orNull(f.valley_travel)}, {"force_N", orNull(f.valley_force)}};
    j["zeros_m"] = {0.0, orNull(f.barrier_travel), orNull(f.second_travel)};
    j["equilibria"] = {
        {"first_m", 0.0}, {"barrier_m", orNull(f.barrier_travel)}, {"second_m", orNull(f.second_travel)}};
    j["barrier_forward_J"] = orNull(f.barrier_forward);
    j["barrier_back_J"] = orNull(f.barrier_back);
    j["hysteresis_N"] = orNull(f.hysteresis);
    j["bistable"] = f.bistable;
  }
  int unstable = 0;
  for (const int stable : table.stable) unstable += stable ? 0 : 1;
  j["points"] = table.travel.size();
  j["unstable_points"] = unstable;
}

/// ArmCurve and PathResult state their costs by the same names.
template <class Result>
void addCosts(const Result& result, nlohmann::json& j) {
  j["status"] = statics::statusName(result.status);
  j["message"] = result.message;
  j["iterations"] = result.iterations;
  j["factorizations"] = result.factorizations;
  j["projections"] = result.projections;
  j["step_halvings"] = result.halvings;
  j["seconds"] = {{"total", result.seconds},
                  {"assembly", result.seconds_assembly},
                  {"factorization", result.seconds_factor},
                  {"solve", result.seconds_solve},
                  {"analysis", result.seconds_analysis}};
}

nlohmann::json summarise(const statics::ArmCurve& curve) {
  nlohmann::json j;
  addCosts(curve, j);
  for (const auto& [key, value] : curve.table.provenance) j["provenance"][key] = value;
  addFeatures(curve.table, j);
  j["forces_are"] = "totals of all arms";
  return j;
}

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

statics::Scene readScene(const CurveOptions& options) {
  statics::Scene scene = statics::loadScene(options.input);
  if (options.cell_size > 0) scene.cell_size = options.cell_size;
  if (options.kernel == "linear") scene.kernel = statics::SceneKernel::LINEAR;
  if (options.kernel == "linear_reduced") scene.kernel = statics::SceneKernel::LINEAR_REDUCED;
  if (options.kernel == "quadratic") scene.kernel = statics::SceneKernel::QUADRATIC;
  if (options.particles > 0) scene.particles = options.particles;
  if (options.steps > 0) scene.steps = options.steps;
  return scene;
}

std::string kernelName(statics::SceneKernel kernel) {
  if (kernel == statics::SceneKernel::LINEAR) return "linear";
  return kernel == statics::SceneKernel::QUADRATIC ? "quadratic" : "linear_reduced";
}

void writeVtu(const std::string& folder, const statics::CompiledScene& compiled, const statics::SceneCurve& curve) {
  std::filesystem::create_directories(folder);
  for (std::size_t k = 0; k < curve.path.points.size(); ++k) {
    char name[32];
    std::snprintf(name, sizeof(name), "/point_%04zu.vtu", k);
    const statics::PathPoint& p = curve.path.points[k];
    common::writeFileAtomically(folder + name, compiled.vtu(p.solution, p.control));
  }
}

nlohmann::json summariseScene(const statics::Scene& scene, const statics::CompiledScene& compiled,
                              const statics::SceneCurve& curve) {
  nlohmann::json j;
  addCosts(curve.path, j);
  j["scene"] = scene.name;
  j["kernel"] = kernelName(scene.kernel);
  j["dimension"] = scene.dimension;
  j["cell_size_m"] = scene.cell_size;
  j["particles_per_axis_in_cut_cells"] = scene.particles;
  j["dof"] = compiled.problem().freeCount();
  j["cells"] = compiled.cellCount();
  j["symmetry"] = compiled.symmetry();
  j["multiplicity"] = compiled.multiplicity();
  j["volume_share_left_out"] = compiled.droppedShare();
  j["scene_sha256"] = scene.sha256;
  j["snapwing_version"] = common::version();
  // Features need a control that grows; a branch with snap-back has none.
  if (scene.control_is_length && curve.limit_points.empty()) addFeatures(curve.table(), j);
  for (const int k : curve.limit_points) j["limit_points"].push_back(curve.path.points[k].control);
  for (const int k : curve.crossings) j["pivot_changes_after"].push_back(curve.path.points[k].control);
  for (std::size_t m = 0; m < scene.monitors.size() && !curve.monitors.empty(); ++m) {
    j["monitors_at_end"][scene.monitors[m].name] = curve.monitors.back()[m];
  }
  return j;
}

int runScene(const CurveOptions& options) {
  const statics::Scene scene = readScene(options);
  const auto compiled = statics::compileScene(scene, options.threads);
  statics::TraceSettings settings;
  settings.newton.cancelled = [] { return interrupted != 0; };
  settings.method = options.arc_length ? statics::TraceMethod::ARC_LENGTH : statics::TraceMethod::AUTOMATIC;
  interrupted = 0;
  const auto previous = std::signal(SIGINT, onInterrupt);
  const auto progress = [&](double share, double control) { return showProgress(options, share, control); };
  const statics::SceneCurve curve = statics::traceScene(scene, *compiled, settings, progress);
  std::signal(SIGINT, previous);
  const nlohmann::json summary = summariseScene(scene, *compiled, curve);
  if (!options.summary.empty()) common::writeFileAtomically(options.summary, summary.dump(2) + "\n");
  std::printf("%s\n", summary.dump(2).c_str());
  // A path that stopped is written as far as it came, but never as a table that others would take for whole.
  if (!options.csv.empty()) common::writeFileAtomically(options.csv, curve.csv(scene));
  if (endsWith(options.output, ".csv")) common::writeFileAtomically(options.output, curve.csv(scene));
  if (!options.vtu.empty()) writeVtu(options.vtu, *compiled, curve);
  if (curve.path.status != statics::SolveStatus::CONVERGED) {
    std::fprintf(stderr, "\nsnapwing curve: %s\n", curve.path.message.c_str());
    return 1;
  }
  if (endsWith(options.output, ".h5")) {
    if (!curve.limit_points.empty()) throw common::Error("the branch snaps back: it has no force table; write a CSV");
    if (!scene.control_is_length) throw common::Error("a force table needs a scene with a driven port, not loads");
    common::ForceTable table = curve.table();
    for (const auto& [key, value] : summary.items()) {
      if (value.is_string() || value.is_number())
        table.provenance[key] = value.is_string() ? value.get<std::string>() : value.dump();
    }
    table.provenance["inputs_sha256"] = scene.sha256;
    common::saveForceTable(table, options.output);
  }
  return 0;
}

/// What cannot be written is refused before the work, not after it.
void checkOutputs(const CurveOptions& options, bool scene) {
  for (const std::string& path : {options.output, options.csv, options.summary}) {
    if (!path.empty()) common::requireFolderOf(path);
  }
  const bool table = endsWith(options.output, ".h5");
  if (!options.output.empty() && !table && !(scene && endsWith(options.output, ".csv"))) {
    throw common::Error("--output is '" + options.output + "'; allowed: a name ending in .h5" +
                        (scene ? " or .csv" : "; the curve as text goes to --csv"));
  }
}

int runCurve(const CurveOptions& options) {
  checkOutputs(options, statics::isScene(options.input));
  if (statics::isScene(options.input)) return runScene(options);
  if (!options.kernel.empty() || !options.vtu.empty()) {
    throw common::Error(
        "--kernel, --particles and --vtu are for scenes; a vehicle's arm is traced with the linear kernel");
  }
  const common::Vehicle vehicle = common::loadVehicle(options.input);
  const elasticity::Material material{vehicle.material.youngs_modulus.value, vehicle.material.poisson_ratio.value,
                                      vehicle.material.mass_density.value};
  const mpm::DensityField design =
      mpm::loadDensityCsv(vehicle.arm.density_file, vehicle.arm.domain_length, vehicle.arm.domain_height);
  statics::ArmProblemSettings settings;
  settings.cell_size = options.cell_size;
  settings.plane = options.plane == "strain" ? elasticity::Plane::STRAIN : elasticity::Plane::STRESS;
  settings.threads = options.threads;
  const statics::ArmProblem arm(vehicle.arm, material, design, settings);

  statics::ArmCurveSettings curve_settings;
  curve_settings.from = std::isnan(options.from) ? vehicle.limits.travel_min : options.from;
  curve_settings.to = std::isnan(options.to) ? vehicle.limits.travel_max : options.to;
  curve_settings.step = options.step;
  curve_settings.back = !options.no_back;
  curve_settings.path.newton.cancelled = [] { return interrupted != 0; };
  curve_settings.progress = [&](double share, double travel) { return showProgress(options, share, travel); };
  interrupted = 0;
  const auto previous = std::signal(SIGINT, onInterrupt);
  statics::ArmCurve curve = statics::traceArm(arm, curve_settings);
  std::signal(SIGINT, previous);

  if (!curve.table.travel.empty()) describe(options, vehicle, arm, curve.table);
  const nlohmann::json summary = summarise(curve);
  if (!options.summary.empty()) common::writeFileAtomically(options.summary, summary.dump(2) + "\n");
  if (curve.status != statics::SolveStatus::CONVERGED) {
    std::fprintf(stderr, "\nsnapwing curve: %s: %s\n", statics::statusName(curve.status).c_str(),
                 curve.message.c_str());
    if (!options.csv.empty() && !curve.table.travel.empty()) writeCsv(options.csv, curve.table);
    return 1;
  }
  if (!options.output.empty()) common::saveForceTable(curve.table, options.output);
  if (!options.csv.empty()) writeCsv(options.csv, curve.table);
  std::printf("%s\n", summary.dump(2).c_str());
  return 0;
}

}  // namespace

void addCurveCommand(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<CurveOptions>();
  CLI::App* command =
      app.add_subcommand("curve", "Trace the force-displacement curve of a vehicle's arm or of a scene");
  command->add_option("input", options->input, "Vehicle or scene file [YAML]")->required();
  command->add_option("-o,--output", options->output, "Force table to write [.h5]; scenes also [.csv]");
  command->add_option("--csv", options->csv, "Curve to write [CSV]");
  command->add_option("--summary", options->summary, "Summary to write [JSON]");
  command->add_option("--cell-size", options->cell_size, "Cell size [m]; default: that of the design")
      ->check(CLI::Range(1e-6, 1e3));
  command->add_option("--kernel", options->kernel, "Scenes: kernel in place of the scene's own")
      ->check(CLI::IsMember({"linear", "linear_reduced", "quadratic"}));
  command->add_option("--particles", options->particles, "Scenes: particles per axis in cut cells")
      ->check(CLI::Range(1, 16));
  command->add_option("--steps", options->steps, "Scenes: points of the path")->check(CLI::Range(1, 100000));
  command->add_flag("--arc-length", options->arc_length, "Scenes: follow the branch by arc length, through snap-back");
  command->add_option("--vtu", options->vtu, "Scenes: folder for deformed cells of each point [VTU]");
  command->add_option("--plane", options->plane, "How the arm behaves across its thickness")
      ->check(CLI::IsMember({"stress", "strain"}))
      ->capture_default_str();
  command->add_option("--step", options->step, "Spacing of the points [m]")
      ->check(CLI::Range(1e-6, 0.1))
      ->capture_default_str();
  command->add_option("--from", options->from, "Lower end of travel [m], <= 0; default: the vehicle's limit");
  command->add_option("--to", options->to, "Upper end of travel [m], > 0; default: the vehicle's limit");
  command->add_flag("--no-back", options->no_back, "Do not trace the way back");
  command->add_option("--threads", options->threads, "Threads of the assembly; the result has the same bits")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command->add_flag("-q,--quiet", options->quiet, "No progress");
  command->callback([options, &exit_code] { exit_code = runCurve(*options); });
}

}  // namespace snapwing::tools
