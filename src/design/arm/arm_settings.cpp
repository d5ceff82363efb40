#include "snapwing/design/arm/arm_settings.h"

#include <algorithm>
#include <functional>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"

namespace snapwing::design {

namespace {

using common::SettingsReader;

/// A list of travels [m], strictly increasing, perhaps empty.
std::vector<double> travels(SettingsReader& map, const std::string& key, double largest) {
  const std::vector<double> values = map.numbers(key, 0, {1e-6, largest}, "m");
  if (std::adjacent_find(values.begin(), values.end(), std::greater_equal<double>()) != values.end()) {
    map.fail(key, "a list out of order", "travels that increase strictly [m]");
  }
  return values;
}

/// A list of at least one number.
std::vector<double> someNumbers(SettingsReader& map, const std::string& key, const common::Range& range,
                                const std::string& unit) {
  const std::vector<double> values = map.numbers(key, 0, range, unit);
  if (values.empty()) map.fail(key, "[]", "at least one number");
  return values;
}

/// A list of cell sizes [m], perhaps empty; the key of one size that older files have is refused with the new one.
std::vector<double> cellSizes(SettingsReader& map, const std::string& key, const std::string& older) {
  if (map.has(older)) map.fail(older, "an older key", key + ": [..], a list of sizes, [] for none");
  if (!map.has(key)) return {};
  return map.numbers(key, 0, {1e-4, 0.01}, "m");
}

std::optional<std::array<double, 2>> interval(SettingsReader& map, const std::string& key, const std::string& unit) {
  if (!map.has(key)) return std::nullopt;
  const std::vector<double> ends = map.numbers(key, 2, {-1e6, 1e6}, unit);
  if (ends[1] < ends[0]) map.fail(key, "ends out of order", "[low, high] " + unit);
  return std::array<double, 2>{ends[0], ends[1]};
}

void readRotationBound(SettingsReader& bounds, ArmDesignSettings& s) {
  if (!bounds.has("rotation")) return;
  if (!s.turns()) bounds.fail("rotation", "given", "a scene with a monitor of a rotation (one with a radius)");
  s.rotation_bound = *interval(bounds, "rotation", "rad");
  if (s.rotation_bound[1] - s.rotation_bound[0] < 1e-3) {
    bounds.fail("rotation", "an interval of less than 0.001 rad", "[low, high] rad further apart");
  }
  s.rotation_travels = travels(bounds, "rotation_travels", s.travel_max);
  if (s.rotation_travels.empty()) bounds.fail("rotation_travels", "[]", "at least one travel [m]");
}

void readDensity(SettingsReader& root, ArmDesignSettings& s) {
  SettingsReader density = root.map("density");
  s.filter_radius = density.number("filter_radius", {0, 0.02}, "m");
  s.sharpness_start = density.number("sharpness_start", {0, 100}, "1");
  s.sharpness_end = density.number("sharpness_end", {s.sharpness_start, 100}, "1");
  s.sharpness_from = density.number("sharpness_from", {0, 1}, "1");
  s.sharpness_to = density.number("sharpness_to", {s.sharpness_from, 1}, "1");
  s.thresholds = someNumbers(density, "thresholds", {0.05, 0.95}, "1");
  s.pin_patch = density.number("pin_patch", {0, 0.02}, "m");
  s.clamp_patch = density.number("clamp_patch", {0, 0.02}, "m");
  s.start_density = density.number("start", {0.01, 1}, "1");
  s.void_threshold = density.numberOr("void_threshold", s.void_threshold, {1e-6, 0.5}, "1");
  density.finish();
  SettingsReader volume = root.map("volume");
  s.volume = volume.number("bound", {0.01, 1}, "1");
  s.volume_start = volume.number("bound_at_start", {s.volume, 1}, "1");
  s.volume_until = volume.number("reached_at", {0, 1}, "1");
  volume.finish();
}

void readTargets(SettingsReader& root, ArmDesignSettings& s) {
  const double largest = s.travel_max;
  SettingsReader objective = root.map("objective");
  s.peak_travel = objective.number("peak_travel", {1e-6, largest}, "m");
  if (objective.has("valley_range")) {
    const std::vector<double> ends = travels(objective, "valley_range", largest);
    if (ends.size() != 2 || ends[0] <= s.peak_travel)
      objective.fail("valley_range", "this", "[from, to] > peak_travel");
    s.valley_range = {ends[0], ends[1]};
  } else {
    const double travel = objective.number("valley_travel", {s.peak_travel + 1e-6, largest}, "m");
    s.valley_range = {travel, travel};
  }
  s.compliance_weight = objective.number("compliance_weight", {0, 1e6}, "N/J");
  s.compliance_force = objective.number("compliance_force", {0, 100}, "N");
  objective.finish();
  SettingsReader bounds = root.map("bounds");
  s.peak_bound = bounds.number("peak_force", {1e-3, 1e3}, "N per arm");
  s.peak_share_least = bounds.numberOr("peak_share_least", 0, {0, 0.99}, "1");
  s.peak_travels = travels(bounds, "peak_travels", largest);
  s.valley_bound = bounds.number("valley_force", {1e-3, 1e3}, "N per arm");
  s.valley_travels = travels(bounds, "valley_travels", largest);
  s.slope_bound = bounds.number("falling_slope", {1e-3, 1e6}, "N/m per arm");
  s.slope_travels = travels(bounds, "slope_travels", largest);
  readRotationBound(bounds, s);
  bounds.finish();
}

void readLimits(SettingsReader& root, ArmDesignSettings& s) {
  if (!root.has("limits")) return;
  SettingsReader limits = root.map("limits");
  s.mass_limit = limits.numberOr("mass", 0, {1e-6, 1e3}, "kg per arm");
  if (limits.has("strain")) {
    s.strain_limit = limits.number("strain", {0.01, 10}, "1");
    s.strain_travels = travels(limits, "strain_travels", s.travel_max);
    if (s.strain_travels.empty()) limits.fail("strain_travels", "[]", "at least one travel [m]");
    s.strain_power = limits.numberOr("strain_power", s.strain_power, {1, 50}, "1");
  }
  limits.finish();
}

void readWishes(SettingsReader& root, ArmDesignSettings& s) {
  if (!root.has("targets")) return;
  SettingsReader targets = root.map("targets");
  s.targets.peak = interval(targets, "peak_force", "N");
  s.targets.valley = interval(targets, "valley_force", "N");
  s.targets.second = interval(targets, "second_equilibrium", "m");
  s.targets.rotation = interval(targets, "rotation", "rad");
  s.targets.hysteresis = targets.numberOr("hysteresis", s.targets.hysteresis, {0, 1}, "1");
  targets.finish();
}

void readStages(SettingsReader& root, ArmDesignSettings& s) {
  s.stages.clear();
  for (SettingsReader& map : root.list("stages")) {
    ArmStage stage;
    stage.volumetric = map.choice("rung", {"planar", "volumetric"}) == "volumetric";
    stage.cell_size = map.number("cell_size", {1e-4, 0.01}, "m");
    stage.iterations = map.integer("iterations", 1, 10000);
    stage.move = map.number("move", {1e-4, 1}, "1");
    map.finish();
    s.stages.push_back(stage);
  }
  if (s.stages.empty()) root.fail("stages", "[]", "at least one stage");
}

void readRun(SettingsReader& root, ArmDesignSettings& s) {
  SettingsReader optimizer = root.map("optimizer");
  s.optimizer = optimizer.choice("method", {"mma", "gcmma", "nlopt"});
  optimizer.finish();
  SettingsReader check = root.map("check");
  s.check_cells = someNumbers(check, "cell_sizes", {1e-4, 0.01}, "m");
  s.check_offset = check.number("printing_error", {0, 0.002}, "m");
  s.check_step = check.number("step", {1e-4, 0.005}, "m");
  s.check_quadratic_cells = cellSizes(check, "quadratic_cell_sizes", "quadratic_cell_size");
  s.check_volumetric_cells = cellSizes(check, "volumetric_cell_sizes", "volumetric_cell_size");
  s.check_volumetric_step = check.number("volumetric_step", {1e-4, 0.005}, "m");
  check.finish();
}

/// The vehicle's arm, or a body of a scene.
void readMechanism(SettingsReader& root, const std::string& vehicle_file, ArmDesignSettings& s) {
  if (!root.has("mechanism")) {
    const std::string named = root.text("vehicle");
    s.vehicle = vehicle::loadVehicle(vehicle_file.empty() ? root.resolvePath(named) : vehicle_file);
    s.copies = s.vehicle.arm.count;
    s.travel_max = s.vehicle.limits.travel_max;
    s.inputs_sha256 = s.vehicle.sha256;
    return;
  }
  if (!vehicle_file.empty()) root.fail("mechanism", "a scene", "the arm of the vehicle that is given (no mechanism)");
  SettingsReader map = root.map("mechanism");
  s.user_scene = true;
  s.scene = scene::loadScene(map.resolvePath(map.text("scene")));
  const std::string body = map.text("body");
  s.copies = s.scene.copies;
  const auto found = std::find_if(s.scene.bodies.begin(), s.scene.bodies.end(),
                                  [&](const scene::SceneBody& b) { return b.name == body; });
  if (found == s.scene.bodies.end()) map.fail("body", "'" + body + "'", "the name of a body of the scene");
  if (!found->shape) map.fail("body", "'" + body + "' with a density", "a body given by a shape: the domain");
  if (!s.scene.control_is_length) map.fail("scene", "one with loads", "a scene with driven ports");
  if (!(s.scene.to > 0)) map.fail("scene", "a path towards negative travel", "a path to > 0");
  s.body = static_cast<int>(found - s.scene.bodies.begin());
  s.travel_max = s.scene.to;
  s.inputs_sha256 = s.scene.sha256;
  map.finish();
}

}  // namespace

ArmDesignSettings loadArmDesignSettings(const std::string& path, const std::string& vehicle_file) {
  SettingsReader root = SettingsReader::fromFile(path);
  ArmDesignSettings s;
  s.file = path;
  s.name = root.text("name");
  readMechanism(root, vehicle_file, s);
  readStages(root, s);
  s.plane =
      root.choice("plane", {"stress", "strain"}) == "strain" ? elasticity::Plane::STRAIN : elasticity::Plane::STRESS;
  s.threads = root.integerOr("threads", 1, 1, 256);
  readDensity(root, s);
  readTargets(root, s);
  readLimits(root, s);
  readRun(root, s);
  readWishes(root, s);
  root.finish();
  s.named_files = root.namedFiles();
  s.named_files.insert(s.named_files.end(), s.scene.named_files.begin(), s.scene.named_files.end());
  s.inputs_sha256 = common::sha256(common::sha256OfFile(path) + s.inputs_sha256);
  return s;
}

int ArmDesignSettings::iterations() const {
  int sum = 0;
  for (const ArmStage& stage : stages) sum += stage.iterations;
  return sum;
}

bool ArmDesignSettings::turns() const { return !user_scene || scene::rotationMonitor(scene) >= 0; }

std::string ArmDesignSettings::hash() const { return common::sha256(inputs_sha256 + common::version()); }

}  // namespace snapwing::design
