// `snapwing curve SCENE`: rung, resolution, checkpoints, features and summary of a traced scene.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "curve_options.h"
#include "curve_summary.h"
#include "snapwing/common/checkpoint_bytes.h"
#include "snapwing/common/error.h"
#include "snapwing/common/json_text.h"
#include "snapwing/common/provenance.h"
#include "snapwing/scene/arm_scene.h"
#include "snapwing/scene/rung.h"
#include "snapwing/statics/checkpoint.h"
#include "snapwing/vehicle/table_origin.h"
#include "snapwing/vehicle/vehicle.h"

namespace snapwing::tools {

namespace {

std::optional<double> asked(double value) { return std::isnan(value) ? std::nullopt : std::optional<double>(value); }

/// A scene file, or the arm of a vehicle as a solid.
scene::Scene sourceScene(const CurveOptions& options) {
  if (scene::isScene(options.input)) return scene::loadScene(options.input);
  const vehicle::Vehicle vehicle = vehicle::loadVehicle(options.input);
  const mpm::DensityField field =
      mpm::loadDensityCsv(vehicle.arm.density_file, vehicle.arm.domain_length, vehicle.arm.domain_height);
  scene::ArmSceneSettings settings;
  settings.dimension = 3;
  settings.kernel = scene::SceneKernel::LINEAR_REDUCED;
  settings.step = options.step;
  settings.back = !options.no_back;
  scene::Scene scene = scene::armScene(vehicle, field, settings);
  scene.copies = vehicle.arm.count;  // totals of all arms, as on the other rungs of a vehicle
  scene.named_files = {vehicle.arm.density_file};
  scene.sha256 = common::sha256(vehicle.sha256 + vehicle::densityBytesOf(vehicle));
  return scene;
}

/// Where measured errors and times lie: as named, else data/trade beside the scene's folder or above.
std::string tradeFolder(const CurveOptions& options) {
  if (!options.trade.empty()) return options.trade;
  std::filesystem::path folder = std::filesystem::path(common::resolvedPath(options.input)).parent_path();
  for (; folder.has_relative_path(); folder = folder.parent_path()) {
    if (std::filesystem::is_directory(folder / "data" / "trade")) return (folder / "data" / "trade").string();
  }
  return "data/trade";
}

void applyRung(scene::Scene& scene, const std::string& rung, const CurveOptions& options) {
  if (rung == "lumped") {
    throw common::Error("--rung lumped: a scene has no table; allowed: planar, volumetric, or a vehicle file");
  }
  const auto plane = options.plane == "strain" ? elasticity::Plane::STRAIN : elasticity::Plane::STRESS;
  if (rung == "planar") scene = scene::asPlanar(scene, plane);
  if (rung == "volumetric") scene = scene::asVolumetric(scene);
}

/// What the options change in a scene. @param choice  set if a measured row decided
scene::Scene askedScene(const CurveOptions& options, std::optional<scene::TradeRow>& choice) {
  scene::Scene scene = sourceScene(options);
  const double own_cell_size = scene.cell_size;
  const bool may_slice = options.rung == "planar" || asked(options.error) || asked(options.seconds);
  if (scene.dimension == 2) {
    refuseArmOptions(options, {"--plane"}, "for slices of a solid; a planar scene states the key 'plane'");
  } else if (!may_slice) {
    refuseArmOptions(options, {"--plane"}, "for slices of a solid: give --rung planar too");
  }
  if (asked(options.error) || asked(options.seconds)) {
    choice =
        scene::chooseRow(scene::loadTrade(tradeFolder(options)), scene, asked(options.error), asked(options.seconds));
    if (choice->rung == "planar" && scene.dimension == 3 && options.plane != "stress") {
      throw common::Error("--plane strain: errors were measured in plane stress; name --rung and --resolution");
    }
    applyRung(scene, choice->rung, options);
    scene.kernel = scene::kernelFromName(choice->kernel);
    scene.cell_size = choice->cell_size;
  }
  applyRung(scene, options.rung, options);
  if (!options.resolution.empty()) scene.cell_size = scene::cellSizeFor(options.resolution, own_cell_size);
  if (options.cell_size > 0) scene.cell_size = options.cell_size;
  if (!options.kernel.empty()) scene.kernel = scene::kernelFromName(options.kernel);
  if (options.particles > 0) scene.particles = options.particles;
  if (options.steps > 0) scene.steps = options.steps;
  if (!options.enforcement.empty()) scene.enforcement = solver::enforcementFromName(options.enforcement);
  if (options.perturb != 0) scene.perturbation = options.perturb;
  return scene;
}

void addModel(const scene::Scene& scene, const scene::CompiledScene& compiled, nlohmann::json& j) {
  j["scene"] = scene.name;
  j["rung"] = scene.dimension == 2 ? "planar" : "volumetric";
  j["kernel"] = scene::kernelName(scene.kernel);
  j["drive"] = solver::enforcementName(scene.enforcement);
  j["dimension"] = scene.dimension;
  if (scene.dimension == 2) j["plane"] = scene.plane == elasticity::Plane::STRAIN ? "strain" : "stress";
  j["cell_size_m"] = scene.cell_size;
  j["particles_per_axis_in_cut_cells"] = scene.particles;
  j["dof"] = compiled.problem().freeCount();
  j["cells"] = compiled.cellCount();
  j["symmetry"] = compiled.symmetry();
  j["multiplicity"] = compiled.multiplicity();
  j["volume_share_left_out"] = compiled.droppedShare();
  const scene::SceneVolume volume = compiled.volume();
  j["modelled_volume_m3"] = volume.modelled;
  j["body_volume_m3"] = volume.bodies;
  j["volume_error"] = volume.modelled / volume.bodies - 1;
  j["scene_sha256"] = scene.sha256;
  if (!scene.content_sha256.empty()) j["content_sha256"] = scene.content_sha256;
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

nlohmann::json summarise(const scene::Scene& scene, const scene::CompiledScene& compiled,
                         const solver::NewtonSettings& newton, const statics::SceneCurve& curve) {
  const bool whole = curve.path.status == solver::SolveStatus::CONVERGED;
  statics::LocatedFeatures located;
  if (whole && scene.control_is_length) {
    located = statics::locateFeaturesOf(compiled.problem(), newton, curve.path.points);
  }
  nlohmann::json j = costsOf(curve.path, located);
  if (!curve.path.account.empty()) j["account"] = curve.path.account;
  addModel(scene, compiled, j);
  const bool loads = !scene.loads.empty() || !scene.gravity.isZero();
  if (scene.control_is_length && curve.monotone()) {
    addFeatures(curve.table(), located, curve.multiplicity, loads, j);
  } else {
    std::vector<int> stable;
    std::vector<double> stiffness;
    for (const statics::PathPoint& p : curve.path.points) {
      stable.push_back(p.stable ? 1 : 0);
      stiffness.push_back(p.stiffness);
    }
    addLocated(located.found, curve.multiplicity, j);
    countStable(stable, stiffness, scene.control_is_length, j);
  }
  addSingular(curve, j);
  for (std::size_t m = 0; m < scene.monitors.size() && !curve.monitors.empty(); ++m) {
    j["monitors_at_end"][scene.monitors[m].name] = curve.monitors.back()[m];
  }
  return j;
}

void writeVtu(const std::string& folder, const scene::CompiledScene& compiled, const statics::SceneCurve& curve) {
  common::makeFolder(folder);
  for (std::size_t k = 0; k < curve.path.points.size(); ++k) {
    char name[32];
    std::snprintf(name, sizeof(name), "/point_%04zu.vtu", k);
    const statics::PathPoint& p = curve.path.points[k];
    common::writeFileAtomically(folder + name, compiled.vtu(p.solution, p.control));
  }
}

/// Writes what was reached, at most once a second and for a twentieth of the time; removes it at the end of a good run.
class Checkpoints {
 public:
  Checkpoints(const CurveOptions& options, const scene::Scene& scene)
      : hash_(statics::traceHash(scene, options.reverse ? "reverse" : "")), file_(fileOf(options)) {
    if (options.resume && file_.empty())
      throw common::Error("--resume needs --output, --csv or --checkpoint: it resumes from the file OUTPUT.checkpoint");
    if (!options.resume || !std::filesystem::exists(file_)) return;
    try {
      known_ = std::make_unique<statics::SceneCurve>(statics::loadCheckpoint(file_, hash_));
    } catch (const common::OtherProgramError& other) {
      std::fprintf(stderr, "snapwing curve: %s; begins anew\n", other.what());
      return;
    }
    if (!options.quiet) std::fprintf(stderr, "resuming after %zu points\n", known_->path.points.size());
  }
  static std::string fileOf(const CurveOptions& options) {
    const std::string& output = options.output.empty() ? options.csv : options.output;
    std::error_code none;
    // A pipe or a device is no place beside which a file can lie.
    const bool plain = !std::filesystem::exists(output, none) || std::filesystem::is_regular_file(output, none);
    return options.checkpoint.empty() && !output.empty() && plain ? output + ".checkpoint" : options.checkpoint;
  }
  const statics::SceneCurve* known() const { return known_.get(); }
  void reached(const statics::SceneCurve& sofar, bool at_once) {
    const auto now = std::chrono::steady_clock::now();
    if (file_.empty() || (!at_once && now < next_)) return;
    try {
      statics::saveCheckpoint(sofar, hash_, file_);
    } catch (const common::FileError& e) {
      // The result does not depend on it: the run goes on.
      if (!warned_) std::fprintf(stderr, "\nsnapwing curve: warning: no checkpoint: %s\n", e.what());
      warned_ = true;
    }
    const auto end = std::chrono::steady_clock::now();
    next_ = end + std::max<std::chrono::steady_clock::duration>(PAUSE, 20 * (end - now));
  }
  void finished() const {
    std::error_code none;
    if (std::filesystem::is_regular_file(file_, none)) std::filesystem::remove(file_, none);
  }

 private:
  static constexpr std::chrono::seconds PAUSE{1};
  std::string hash_, file_;
  bool warned_ = false;
  std::unique_ptr<statics::SceneCurve> known_;
  std::chrono::steady_clock::time_point next_ = std::chrono::steady_clock::now() + PAUSE;
};

statics::TraceSettings traceSettings(const CurveOptions& options) {
  statics::TraceSettings settings;
  settings.newton.cancelled = InterruptGuard::interrupted;
  settings.newton.projection = solver::projectionFromName(options.projection);
  settings.reverse = options.reverse;
  settings.method = options.no_arc       ? statics::TraceMethod::DISPLACEMENT
                    : options.arc_length ? statics::TraceMethod::ARC_LENGTH
                                         : statics::TraceMethod::AUTOMATIC;
  return settings;
}

void writeTable(const CurveOptions& options, const scene::Scene& scene, const statics::SceneCurve& curve,
                const nlohmann::json& summary) {
  if (!curve.monotone()) throw common::Error("the branch snaps back: it has no force table; write a CSV");
  if (!scene.control_is_length) throw common::Error("a force table needs a scene with a driven port, not loads");
  vehicle::ForceTable table = curve.table();
  for (const auto& [key, value] : summary.items()) {
    if (value.is_string() || value.is_number())
      table.provenance[key] = value.is_string() ? value.get<std::string>() : value.dump();
  }
  table.provenance["inputs_sha256"] = scene.sha256;
  if (!scene::isScene(options.input)) {  // the arm of a vehicle as a solid
    const vehicle::Vehicle vehicle = vehicle::loadVehicle(options.input);
    vehicle::noteOrigin(vehicle, vehicle::densityBytesOf(vehicle), &table.provenance);
    table.arm_count = vehicle.arm.count;
  }
  vehicle::saveForceTable(table, options.output);
}

}  // namespace

int runScene(const CurveOptions& options) {
  std::optional<scene::TradeRow> choice;
  const scene::Scene scene = askedScene(options, choice);
  checkFiles(options, scene.named_files, Checkpoints::fileOf(options));
  Checkpoints checkpoints(options, scene);
  const auto compiled = scene::compileScene(scene, options.threads);
  statics::TraceSettings settings = traceSettings(options);
  settings.resume = checkpoints.known();
  settings.reached = [&](const statics::SceneCurve& sofar) {
    checkpoints.reached(sofar, InterruptGuard::interrupted());
  };
  const InterruptGuard guard;
  const statics::SceneCurve curve = statics::traceScene(
      scene, *compiled, settings, [&](double share, double control) { return showProgress(options, share, control); });
  const bool good = curve.path.status == solver::SolveStatus::CONVERGED;
  nlohmann::json summary = summarise(scene, *compiled, settings.newton, curve);
  if (choice) {
    summary["chosen"] = {
        {"measured_error", choice->error}, {"measured_seconds", choice->seconds}, {"table", choice->file}};
  }
  // A path that stopped is written as far as it came, but never as a table that others would take for whole.
  const std::string csv = curve.csv(scene);
  if (good && endsWith(options.output, ".h5")) writeTable(options, scene, curve, summary);
  if (!options.csv.empty()) common::writeFileAtomically(options.csv, csv);
  if (endsWith(options.output, ".csv")) common::writeFileAtomically(options.output, csv);
  if (!options.summary.empty()) common::writeFileAtomically(options.summary, common::jsonText(summary));
  if (!options.vtu.empty()) writeVtu(options.vtu, *compiled, curve);
  if (!options.plot.empty() && !curve.path.points.empty()) plotCurve(csv, common::jsonText(summary), options.plot);
  if (good) checkpoints.finished();
  printAnswer(options, summary);
  if (!good) std::fprintf(stderr, "\nsnapwing curve: %s\n", curve.path.message.c_str());
  return good ? 0 : 1;
}

}  // namespace snapwing::tools
