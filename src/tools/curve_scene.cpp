// `snapwing curve SCENE`: rung, resolution, checkpoints, features and summary of a traced scene.
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "curve_options.h"
#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"
#include "snapwing/common/table_origin.h"
#include "snapwing/common/vehicle.h"
#include "snapwing/design/arm_scene.h"
#include "snapwing/statics/checkpoint.h"
#include "snapwing/statics/features.h"
#include "snapwing/statics/rung.h"

namespace snapwing::tools {

namespace {

std::optional<double> asked(double value) { return std::isnan(value) ? std::nullopt : std::optional<double>(value); }

/// A scene file, or the arm of a vehicle as a solid.
statics::Scene sourceScene(const CurveOptions& options) {
  if (statics::isScene(options.input)) return statics::loadScene(options.input);
  const common::Vehicle vehicle = common::loadVehicle(options.input);
  const mpm::DensityField field =
      mpm::loadDensityCsv(vehicle.arm.density_file, vehicle.arm.domain_length, vehicle.arm.domain_height);
  design::ArmSceneSettings settings;
  settings.dimension = 3;
  settings.kernel = statics::SceneKernel::LINEAR_REDUCED;
  settings.step = options.step;
  settings.back = !options.no_back;
  statics::Scene scene = design::armScene(vehicle, field, settings);
  scene.copies = vehicle.arm.count;  // totals of all arms, as on the other rungs of a vehicle
  scene.sha256 = common::sha256(vehicle.sha256 + common::densityBytesOf(vehicle));
  return scene;
}

/// Where measured errors and times lie: as named, else data/trade beside the scene's folder or above.
std::string tradeFolder(const CurveOptions& options) {
  if (!options.trade.empty()) return options.trade;
  std::filesystem::path folder = std::filesystem::absolute(options.input).parent_path();
  for (; folder.has_relative_path(); folder = folder.parent_path()) {
    if (std::filesystem::is_directory(folder / "data" / "trade")) return (folder / "data" / "trade").string();
  }
  return "data/trade";
}

void applyRung(statics::Scene& scene, const std::string& rung, const CurveOptions& options) {
  if (rung == "lumped") {
    throw common::Error("--rung lumped: a scene has no table; allowed: planar, volumetric, or a vehicle file");
  }
  const auto plane = options.plane == "strain" ? elasticity::Plane::STRAIN : elasticity::Plane::STRESS;
  if (rung == "planar") scene = statics::asPlanar(scene, plane);
  if (rung == "volumetric") scene = statics::asVolumetric(scene);
}

/// What the options change in a scene. @param choice  set if a measured row decided
statics::Scene askedScene(const CurveOptions& options, std::optional<statics::TradeRow>& choice) {
  statics::Scene scene = sourceScene(options);
  const double own_cell_size = scene.cell_size;
  if (asked(options.error) || asked(options.seconds)) {
    choice = statics::chooseRow(statics::loadTrade(tradeFolder(options)), scene.name, asked(options.error),
                                asked(options.seconds));
    applyRung(scene, choice->rung, options);
    scene.kernel = statics::kernelFromName(choice->kernel);
    scene.cell_size = choice->cell_size;
  }
  applyRung(scene, options.rung, options);
  if (!options.resolution.empty()) scene.cell_size = statics::cellSizeFor(options.resolution, own_cell_size);
  if (options.cell_size > 0) scene.cell_size = options.cell_size;
  if (!options.kernel.empty()) scene.kernel = statics::kernelFromName(options.kernel);
  if (options.particles > 0) scene.particles = options.particles;
  if (options.steps > 0) scene.steps = options.steps;
  if (!options.drive.empty()) scene.drive = statics::driveFromName(options.drive);
  if (options.perturb != 0) scene.perturbation = options.perturb;
  return scene;
}

void addModel(const statics::Scene& scene, const statics::CompiledScene& compiled, nlohmann::json& j) {
  j["scene"] = scene.name;
  j["rung"] = scene.dimension == 2 ? "planar" : "volumetric";
  j["kernel"] = statics::kernelName(scene.kernel);
  j["drive"] = statics::driveName(scene.drive);
  j["dimension"] = scene.dimension;
  if (scene.dimension == 2) j["plane"] = scene.plane == elasticity::Plane::STRAIN ? "strain" : "stress";
  j["cell_size_m"] = scene.cell_size;
  j["particles_per_axis_in_cut_cells"] = scene.particles;
  j["dof"] = compiled.problem().freeCount();
  j["cells"] = compiled.cellCount();
  j["symmetry"] = compiled.symmetry();
  j["multiplicity"] = compiled.multiplicity();
  j["volume_share_left_out"] = compiled.droppedShare();
  const statics::SceneVolume volume = compiled.volume();
  j["modelled_volume_m3"] = volume.modelled;
  j["body_volume_m3"] = volume.bodies;
  j["volume_error"] = volume.modelled / volume.bodies - 1;
  j["scene_sha256"] = scene.sha256;
  j["snapwing_version"] = common::version();
}

void addSingular(const statics::SceneCurve& curve, nlohmann::json& j) {
  for (const int k : curve.limit_points) j["limit_points"].push_back(curve.path.points[k].control);
  for (const int k : curve.crossings) j["pivot_changes_after"].push_back(curve.path.points[k].control);
  for (const statics::SingularPoint& s : curve.path.singular) {
    j["singular_points"].push_back(
        {{"kind", s.kind == statics::SingularKind::BIFURCATION ? "bifurcation" : "limit point"},
         {"control", s.point.p(0)},
         {"force", curve.multiplicity * s.point.force()},
         {"mode_dot_load", s.load_share},
         {"control_rate", s.control_rate},
         {"negative_pivots", {s.before, s.after}},
         {"accuracy", s.accuracy},
         {"followed", s.followed}});
  }
}

/// Peaks, valleys and zeros that were solved for, in place of the interpolated ones.
void addLocated(const statics::CompiledScene& compiled, const statics::NewtonSettings& newton,
                const statics::SceneCurve& curve, nlohmann::json& j) {
  statics::EquilibriumSolver solver(compiled.problem(), newton);
  std::vector<double> zeros;
  for (const statics::Feature& f : statics::locateFeatures(solver, curve.path.points)) {
    const double force = curve.multiplicity * f.point.force;
    const std::string kind = statics::featureName(f.kind);
    j["located"].push_back({{"kind", kind},
                            {"control", f.point.control},
                            {"force", force},
                            {"energy", curve.multiplicity * f.point.energy},
                            {"stable", f.point.stable && f.point.stiffness > 0},
                            {"accuracy", f.accuracy},
                            {"remainder", f.remainder}});
    if (f.kind == statics::FeatureKind::ZERO) zeros.push_back(f.point.control);
    const bool taken = j.contains(kind) && j[kind].contains("exact");
    if (f.kind != statics::FeatureKind::ZERO && j.contains(kind) && !taken)
      j[kind] = {{"travel_m", f.point.control}, {"force_N", force}, {"exact", true}};
  }
  if (!zeros.empty() && j.contains("zeros_m")) j["zeros_m"] = zeros;
}

nlohmann::json summarise(const statics::Scene& scene, const statics::CompiledScene& compiled,
                         const statics::NewtonSettings& newton, const statics::SceneCurve& curve) {
  nlohmann::json j = costsOf(curve.path);
  if (!curve.path.account.empty()) j["account"] = curve.path.account;
  addModel(scene, compiled, j);
  const bool whole = curve.path.status == statics::SolveStatus::CONVERGED;
  if (scene.control_is_length && curve.monotone()) addFeatures(curve.table(), j);
  if (whole && scene.control_is_length) addLocated(compiled, newton, curve, j);
  addSingular(curve, j);
  for (std::size_t m = 0; m < scene.monitors.size() && !curve.monitors.empty(); ++m) {
    j["monitors_at_end"][scene.monitors[m].name] = curve.monitors.back()[m];
  }
  return j;
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

/// Writes what was reached, at most once a second, and removes it at the end of a good run.
class Checkpoints {
 public:
  Checkpoints(const CurveOptions& options, const statics::Scene& scene)
      : hash_(statics::traceHash(scene, options.reverse ? "reverse" : "")), file_(options.checkpoint) {
    const std::string& output = options.output.empty() ? options.csv : options.output;
    if (file_.empty() && !output.empty()) file_ = output + ".checkpoint";
    if (options.resume && file_.empty())
      throw common::Error("--resume needs --output, --csv or --checkpoint: it goes on from the file OUTPUT.checkpoint");
    if (!options.resume || !std::filesystem::exists(file_)) return;
    known_ = std::make_unique<statics::SceneCurve>(statics::loadCheckpoint(file_, hash_));
    if (!options.quiet) std::fprintf(stderr, "resuming after %zu points\n", known_->path.points.size());
  }
  const statics::SceneCurve* known() const { return known_.get(); }
  void reached(const statics::SceneCurve& sofar, bool at_once) {
    const auto now = std::chrono::steady_clock::now();
    if (file_.empty() || (!at_once && now - last_ < std::chrono::seconds(1))) return;
    statics::saveCheckpoint(sofar, hash_, file_);
    last_ = now;
  }
  void finished() const {
    if (!file_.empty()) std::filesystem::remove(file_);
  }

 private:
  std::string hash_, file_;
  std::unique_ptr<statics::SceneCurve> known_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

statics::TraceSettings traceSettings(const CurveOptions& options) {
  statics::TraceSettings settings;
  settings.newton.cancelled = InterruptGuard::interrupted;
  settings.newton.projection = statics::projectionFromName(options.projection);
  settings.reverse = options.reverse;
  settings.method = options.no_arc       ? statics::TraceMethod::DISPLACEMENT
                    : options.arc_length ? statics::TraceMethod::ARC_LENGTH
                                         : statics::TraceMethod::AUTOMATIC;
  return settings;
}

void writeTable(const CurveOptions& options, const statics::Scene& scene, const statics::SceneCurve& curve,
                const nlohmann::json& summary) {
  if (!curve.monotone()) throw common::Error("the branch snaps back: it has no force table; write a CSV");
  if (!scene.control_is_length) throw common::Error("a force table needs a scene with a driven port, not loads");
  common::ForceTable table = curve.table();
  for (const auto& [key, value] : summary.items()) {
    if (value.is_string() || value.is_number())
      table.provenance[key] = value.is_string() ? value.get<std::string>() : value.dump();
  }
  table.provenance["inputs_sha256"] = scene.sha256;
  if (!statics::isScene(options.input)) {  // the arm of a vehicle as a solid
    const common::Vehicle vehicle = common::loadVehicle(options.input);
    common::noteOrigin(vehicle, common::densityBytesOf(vehicle), &table.provenance);
    table.arm_count = vehicle.arm.count;
  }
  common::saveForceTable(table, options.output);
}

}  // namespace

int runScene(const CurveOptions& options) {
  std::optional<statics::TradeRow> choice;
  const statics::Scene scene = askedScene(options, choice);
  if (!options.plot.empty()) requirePlotting();
  Checkpoints checkpoints(options, scene);
  const auto compiled = statics::compileScene(scene, options.threads);
  statics::TraceSettings settings = traceSettings(options);
  settings.resume = checkpoints.known();
  settings.reached = [&](const statics::SceneCurve& sofar) {
    checkpoints.reached(sofar, InterruptGuard::interrupted());
  };
  const InterruptGuard guard;
  const statics::SceneCurve curve = statics::traceScene(
      scene, *compiled, settings, [&](double share, double control) { return showProgress(options, share, control); });
  const bool good = curve.path.status == statics::SolveStatus::CONVERGED;
  nlohmann::json summary = summarise(scene, *compiled, settings.newton, curve);
  if (choice) {
    summary["chosen"] = {
        {"measured_error", choice->error}, {"measured_seconds", choice->seconds}, {"table", choice->file}};
  }
  if (!options.summary.empty()) common::writeFileAtomically(options.summary, summary.dump(2) + "\n");
  std::printf("%s\n", summary.dump(2).c_str());
  // A path that stopped is written as far as it came, but never as a table that others would take for whole.
  const std::string csv = curve.csv(scene);
  if (!options.csv.empty()) common::writeFileAtomically(options.csv, csv);
  if (endsWith(options.output, ".csv")) common::writeFileAtomically(options.output, csv);
  if (!options.vtu.empty()) writeVtu(options.vtu, *compiled, curve);
  if (!options.plot.empty() && !curve.path.points.empty()) plotCurve(csv, summary.dump(), options.plot);
  if (!good) {
    std::fprintf(stderr, "\nsnapwing curve: %s\n", curve.path.message.c_str());
    return 1;
  }
  if (endsWith(options.output, ".h5")) writeTable(options, scene, curve, summary);
  checkpoints.finished();
  return 0;
}

}  // namespace snapwing::tools
