// `snapwing curve`: traces the force-displacement curve of a vehicle's arm, or of any scene, with units and provenance.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "commands.h"
#include "curve_options.h"
#include "curve_summary.h"
#include "numbers.h"
#include "snapwing/common/error.h"
#include "snapwing/common/json_text.h"
#include "snapwing/common/provenance.h"
#include "snapwing/scene/arm_scene.h"
#include "snapwing/scene/rung.h"
#include "snapwing/statics/features.h"
#include "snapwing/statics/scene_curve.h"
#include "snapwing/vehicle/force_table.h"
#include "snapwing/vehicle/table_origin.h"
#include "snapwing/vehicle/vehicle.h"

namespace snapwing::tools {

namespace {
volatile std::sig_atomic_t stop_asked = 0;
void onInterrupt(int) { stop_asked = 1; }
}  // namespace

InterruptGuard::InterruptGuard() {
  stop_asked = 0;
  previous_ = std::signal(SIGINT, onInterrupt);
}
InterruptGuard::~InterruptGuard() { std::signal(SIGINT, previous_); }
bool InterruptGuard::interrupted() { return stop_asked != 0; }

bool showProgress(const CurveOptions& options, double share, double control) {
  if (!options.quiet) {
    std::fprintf(stderr, "\r%3.0f %%  at %10.5g ", 100 * share, control);
    if (share >= 1) std::fprintf(stderr, "\n");
    std::fflush(stderr);
  }
  return stop_asked != 0;
}

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

void checkFiles(const CurveOptions& options, const std::vector<std::string>& inputs, const std::string& checkpoint) {
  common::OutputFiles files;
  files.reads(options.input, "the input");
  files.reads(inputs, "a file that the input names");
  const std::pair<const std::string&, const char*> outputs[] = {{options.output, "--output"},
                                                                {options.csv, "--csv"},
                                                                {options.summary, "--summary"},
                                                                {options.plot, "--plot"},
                                                                {checkpoint, "--checkpoint"}};
  for (const auto& [path, option] : outputs) files.writes(path, option);
  files.fills(options.vtu, "--vtu");
  if (!options.plot.empty()) requirePlotting(options.plot);
}

void printAnswer(const CurveOptions& options, const nlohmann::json& summary) {
  std::vector<std::string> files;
  for (const std::string& path : {options.output, options.csv, options.summary, options.plot, options.vtu}) {
    std::error_code none;
    if (!path.empty() && std::filesystem::exists(path, none)) files.push_back(path);
  }
  const std::string text = options.json ? common::jsonText(summary) : curveAnswer(summary, files);
  std::fputs(text.c_str(), stdout);
}

namespace {

constexpr int LARGEST_COUNT = 100000;

std::string toText(double value) {
  std::ostringstream text;
  text.precision(10);
  text << value;
  return text.str();
}

void describe(const CurveOptions& options, const vehicle::Vehicle& vehicle, double cell_size, int unknowns,
              vehicle::ForceTable& table) {
  table.arm_count = vehicle.arm.count;
  auto& p = table.provenance;
  vehicle::noteOrigin(vehicle, vehicle::densityBytesOf(vehicle), &p);
  p["rung"] = "planar";
  p["plane"] = options.plane;
  p["kernel"] = "linear";
  p["cell_size_m"] = toText(cell_size);
  p["step_m"] = toText(options.step);
  p["dof"] = std::to_string(unknowns);
  p["snapwing_version"] = common::version();
  p["command"] = "snapwing curve, plane " + options.plane + ", from " + toText(table.travel.front()) + " m to " +
                 toText(table.travel.back()) + " m";
}

std::string csvText(const vehicle::ForceTable& table) {
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
  return text.str();
}

void writeCsv(const std::string& path, const vehicle::ForceTable& table) {
  common::writeFileAtomically(path, csvText(table));
}

nlohmann::json summarise(const statics::PathResult& costs, const statics::LocatedFeatures& located,
                         const vehicle::ForceTable& table) {
  nlohmann::json j = costsOf(costs, located);
  for (const auto& [key, value] : table.provenance) j["provenance"][key] = value;
  addFeatures(table, located, table.arm_count, false, j);
  j["forces_are"] = "totals of all arms";
  return j;
}

void checkEndings(const CurveOptions& options, bool scene) {
  const bool table = endsWith(options.output, ".h5");
  if (!options.output.empty() && !table && !(scene && endsWith(options.output, ".csv"))) {
    throw common::Error("--output is '" + options.output + "'; allowed: a name ending in .h5" +
                        (scene ? " or .csv" : "; the curve as text goes to --csv"));
  }
}

void writeResults(const CurveOptions& options, const vehicle::ForceTable& table, const nlohmann::json& summary) {
  if (!options.csv.empty()) writeCsv(options.csv, table);
  if (!options.summary.empty()) common::writeFileAtomically(options.summary, common::jsonText(summary));
  if (!options.plot.empty()) plotCurve(csvText(table), common::jsonText(summary), options.plot);
}

/// The lumped rung of a vehicle is its table: nothing is solved.
int runTable(const CurveOptions& options) {
  if (!options.output.empty())
    throw common::Error("--output: --rung lumped is a table already; the curve goes to --csv");
  const vehicle::Vehicle vehicle = vehicle::loadVehicle(options.input);
  checkFiles(options, {vehicle.arm.table_file}, "");
  const vehicle::ForceTable table = vehicle::armTableOf(vehicle);
  nlohmann::json summary;
  for (const auto& [key, value] : table.provenance) summary["provenance"][key] = value;
  summary["rung"] = "lumped";
  summary["status"] = "converged";
  addFeatures(table, {}, 1, false, summary);
  writeResults(options, table, summary);
  printAnswer(options, summary);
  return 0;
}

/// The planar arm is traced with the linear kernel along the vehicle's travel, both ways.
void refuseSceneOptions(const CurveOptions& o) {
  const std::pair<bool, const char*> given[] = {{!o.kernel.empty(), "--kernel"},
                                                {o.particles > 0, "--particles"},
                                                {!o.vtu.empty(), "--vtu"},
                                                {o.steps > 0, "--steps"},
                                                {o.arc_length, "--arc-length"},
                                                {o.no_arc, "--no-arc-length"},
                                                {!o.enforcement.empty(), "--drive"},
                                                {o.reverse, "--reverse"},
                                                {o.resume, "--resume"},
                                                {!o.checkpoint.empty(), "--checkpoint"},
                                                {o.perturb != 0, "--perturb"},
                                                {!std::isnan(o.error), "--error"},
                                                {!std::isnan(o.seconds), "--seconds"}};
  for (const auto& [is_given, name] : given) {
    if (is_given)
      throw common::Error(
          std::string(name) +
          " is for scenes and solids; a vehicle's arm is traced in the plane unless --rung volumetric is given");
  }
}

scene::ArmSceneSettings armSettings(const CurveOptions& options, const vehicle::Vehicle& vehicle,
                                    const mpm::DensityField& design) {
  scene::ArmSceneSettings settings;
  settings.cell_size = options.cell_size;
  if (!options.resolution.empty()) settings.cell_size = scene::cellSizeFor(options.resolution, design.cell_size);
  settings.plane = options.plane == "strain" ? elasticity::Plane::STRAIN : elasticity::Plane::STRESS;
  settings.from = std::isnan(options.from) ? vehicle.limits.travel_min : options.from;
  settings.to = std::isnan(options.to) ? vehicle.limits.travel_max : options.to;
  settings.step = options.step;
  settings.back = !options.no_back;
  settings.validate();
  const double points = (settings.to - settings.from) / settings.step;
  if (points > LARGEST_COUNT) {
    throw common::Error("--step " + toText(options.step) + " m makes " + toText(points) +
                        " points from --from to --to; allowed: at most " + std::to_string(LARGEST_COUNT));
  }
  return settings;
}

/// The arm of a vehicle in the plane.
int runArm(const CurveOptions& options) {
  const vehicle::Vehicle vehicle = vehicle::loadVehicle(options.input);
  checkFiles(options, {vehicle.arm.density_file}, "");
  vehicle::densityBytesOf(vehicle);
  const mpm::DensityField design =
      mpm::loadDensityCsv(vehicle.arm.density_file, vehicle.arm.domain_length, vehicle.arm.domain_height);
  const scene::Scene scene = scene::armScene(vehicle, design, armSettings(options, vehicle, design));
  const auto arm = scene::compileScene(scene, options.threads);
  statics::TraceSettings trace;
  trace.newton.cancelled = InterruptGuard::interrupted;
  const InterruptGuard guard;
  const statics::SceneCurve curve = statics::traceScene(
      scene, *arm, trace, [&](double share, double travel) { return showProgress(options, share, travel); });
  statics::LocatedFeatures located;
  if (curve.path.status == solver::SolveStatus::CONVERGED) {
    located = statics::locateFeaturesOf(arm->problem(), trace.newton, curve.path.points);
  }

  vehicle::ForceTable table = curve.table();
  table.shapes = statics::outlineAlong(scene, *arm, curve, 0);
  if (!table.travel.empty()) describe(options, vehicle, scene.cell_size, arm->problem().freeCount(), table);
  const statics::PathResult whole = curve.costs();
  const nlohmann::json summary = summarise(whole, located, table);
  const bool good = whole.status == solver::SolveStatus::CONVERGED;
  if (good && !options.output.empty()) vehicle::saveForceTable(table, options.output);
  if (!table.travel.empty()) writeResults(options, table, summary);
  if (!good) {
    std::fprintf(stderr, "\nsnapwing curve: %s: %s\n", solver::statusName(whole.status).c_str(), whole.message.c_str());
    return 1;
  }
  printAnswer(options, summary);
  return 0;
}

int runCurve(const CurveOptions& options) {
  const bool scene = scene::isScene(options.input);
  const bool traced_as_scene = scene || options.rung == "volumetric";
  checkEndings(options, traced_as_scene);
  if (scene) refuseArmOptions(options, {"--step", "--no-back"}, "for the arm of a vehicle; a scene states its path");
  if (traced_as_scene) {
    refuseArmOptions(options, {"--from", "--to"}, "for the planar arm of a vehicle");
    return runScene(options);
  }
  refuseSceneOptions(options);
  if (options.rung == "lumped") {
    refuseArmOptions(options, {"--step", "--no-back", "--from", "--to", "--plane"},
                     "for a path that is traced, not a table");
  }
  return options.rung == "lumped" ? runTable(options) : runArm(options);
}

}  // namespace

void refuseArmOptions(const CurveOptions& options, const std::vector<std::string>& meaningless,
                      const std::string& where) {
  for (const std::string& name : meaningless) {
    const auto& given = options.arm_options;
    if (std::find(given.begin(), given.end(), name) != given.end()) throw common::Error(name + " is " + where);
  }
}

void addCurveCommand(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<CurveOptions>();
  CLI::App* command =
      app.add_subcommand("curve", "Trace the force-displacement curve of a vehicle's arm or of a scene");
  command->add_option("input", options->input, "Vehicle or scene file [YAML]")->required();
  command->add_option("-o,--output", options->output, "Force table to write [.h5]; scenes also [.csv]");
  command->add_option("--csv", options->csv, "Curve to write [CSV]");
  command->add_option("--summary", options->summary, "Summary to write [JSON]");
  command->add_option("--cell-size", options->cell_size, "Cell size [m]; default: that of the design")
      ->check(realNumber(1e-6, 1e3, "m"));
  command->add_option("--rung", options->rung, "Fidelity: a vehicle's table, a slice, a 3-D solid")
      ->check(CLI::IsMember({"lumped", "planar", "volumetric"}));
  command->add_option("--resolution", options->resolution,
                      "Cell size as 0.4mm or 4e-4 [m], or x2: half the scene's cells");
  command->add_option("--kernel", options->kernel, "Scenes: kernel in place of the scene's own")
      ->check(CLI::IsMember({"linear", "linear_reduced", "quadratic"}));
  command->add_option("--particles", options->particles, "Scenes: particles per axis in cut cells")
      ->check(wholeNumber(1, 16));
  command->add_option("--steps", options->steps, "Scenes: points of the path")->check(wholeNumber(1, LARGEST_COUNT));
  command->add_flag("--arc-length", options->arc_length, "Scenes: follow the branch by arc length, through snap-back");
  command->add_flag("--no-arc-length", options->no_arc, "Scenes: displacement control alone, jumps included");
  command->add_option("--drive", options->enforcement, "Scenes: enforcement of ports and joints")
      ->check(CLI::IsMember({"elimination", "augmented_lagrangian", "multipliers"}));
  command
      ->add_option("--projection", options->projection, "When element Hessians are projected to be positive definite")
      ->check(CLI::IsMember({"on_demand", "clamp", "absolute"}))
      ->capture_default_str();
  command
      ->add_option("--perturb", options->perturb,
                   "Scenes: leave bifurcations along the critical mode, by this motion [m]")
      ->check(realNumber(-1, 1, "m"));
  command->add_flag("--reverse", options->reverse, "Scenes: from the far end back to 0");
  command
      ->add_option("--error", options->error, "Scenes: cheapest measured rung with at most this error, as 2% or 0.02")
      ->transform(shareOrPercent());
  command->add_option("--seconds", options->seconds, "Scenes: most accurate measured rung within this time [s]")
      ->check(realNumber(0, 1e9, "s", true));
  command->add_option("--trade", options->trade, "Folder of measured errors and times; default: data/trade");
  command->add_flag("--resume", options->resume, "Scenes: resume from the checkpoint of an interrupted run");
  command->add_option("--checkpoint", options->checkpoint, "Scenes: checkpoint file; default: OUTPUT.checkpoint");
  command->add_option("--plot", options->plot, "Picture of the curve [PNG, PDF, SVG]");
  command->add_option("--vtu", options->vtu, "Scenes: folder for deformed cells of each point [VTU]");
  command->add_option("--plane", options->plane, "Across the thickness of a slice: no stress or no strain")
      ->check(CLI::IsMember({"stress", "strain"}))
      ->capture_default_str();
  command->add_option("--step", options->step, "Vehicles: spacing of the points [m]")
      ->check(realNumber(1e-6, 0.1, "m"))
      ->capture_default_str();
  command->add_option("--from", options->from, "Vehicles: lower end of travel [m], <= 0; default: the vehicle's limit")
      ->check(realNumber(-10, 0, "m"));
  command->add_option("--to", options->to, "Vehicles: upper end of travel [m], > 0; default: the vehicle's limit")
      ->check(realNumber(0, 10, "m", true));
  command->add_flag("--no-back", options->no_back, "Vehicles: do not trace the way back");
  command->add_option("--threads", options->threads, "Threads of the assembly; the result has the same bits")
      ->check(wholeNumber(1, 256))
      ->capture_default_str();
  command->add_flag("--json", options->json, "Print the summary as JSON in place of a few lines");
  command->add_flag("-q,--quiet", options->quiet, "No progress");
  command->callback([options, command, &exit_code] {
    for (const char* name : {"--step", "--no-back", "--from", "--to", "--plane"}) {
      if (command->count(name) > 0) options->arm_options.emplace_back(name);
    }
    exit_code = runCurve(*options);
  });
}

}  // namespace snapwing::tools
