#include "snapwing/design/arm_settings.h"

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
  const double largest = s.vehicle.limits.travel_max;
  SettingsReader objective = root.map("objective");
  s.peak_travel = objective.number("peak_travel", {1e-6, largest}, "m");
  s.valley_travel = objective.number("valley_travel", {s.peak_travel + 1e-6, largest}, "m");
  s.compliance_weight = objective.number("compliance_weight", {0, 1e6}, "N/J");
  s.compliance_force = objective.number("compliance_force", {0, 100}, "N");
  objective.finish();
  SettingsReader bounds = root.map("bounds");
  s.peak_bound = bounds.number("peak_force", {1e-3, 1e3}, "N per arm");
  s.peak_travels = travels(bounds, "peak_travels", largest);
  s.valley_bound = bounds.number("valley_force", {1e-3, 1e3}, "N per arm");
  s.valley_travels = travels(bounds, "valley_travels", largest);
  s.slope_bound = bounds.number("falling_slope", {1e-3, 1e6}, "N/m per arm");
  s.slope_travels = travels(bounds, "slope_travels", largest);
  bounds.finish();
}

void readRun(SettingsReader& root, ArmDesignSettings& s) {
  SettingsReader optimizer = root.map("optimizer");
  s.optimizer = optimizer.choice("method", {"mma", "gcmma", "nlopt"});
  s.iterations = optimizer.integer("iterations", 1, 10000);
  s.move = optimizer.number("move", {1e-4, 1}, "1");
  optimizer.finish();
  SettingsReader check = root.map("check");
  s.check_cells = someNumbers(check, "cell_sizes", {1e-4, 0.01}, "m");
  s.check_offset = check.number("printing_error", {0, 0.002}, "m");
  s.check_step = check.number("step", {1e-4, 0.005}, "m");
  s.check_quadratic_cell = check.number("quadratic_cell_size", {0, 0.01}, "m");
  s.check_volumetric_cell = check.number("volumetric_cell_size", {0, 0.01}, "m");
  s.check_volumetric_step = check.number("volumetric_step", {1e-4, 0.005}, "m");
  check.finish();
}

}  // namespace

ArmDesignSettings loadArmDesignSettings(const std::string& path) {
  SettingsReader root = SettingsReader::fromFile(path);
  ArmDesignSettings s;
  s.file = path;
  s.name = root.text("name");
  s.vehicle = common::loadVehicle(root.resolvePath(root.text("vehicle")));
  s.cell_size = root.number("cell_size", {1e-4, 0.01}, "m");
  s.plane =
      root.choice("plane", {"stress", "strain"}) == "strain" ? elasticity::Plane::STRAIN : elasticity::Plane::STRESS;
  s.threads = root.integerOr("threads", 1, 1, 256);
  readDensity(root, s);
  readTargets(root, s);
  readRun(root, s);
  root.finish();
  return s;
}

std::string ArmDesignSettings::hash() const {
  return common::sha256(common::readFile(file) + common::readFile(vehicle.file) + common::version());
}

}  // namespace snapwing::design
