#include "snapwing/design/wing/wing_settings.h"

#include <cmath>
#include <filesystem>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"

namespace snapwing::design {

using common::Range;
using common::SettingsReader;
using Eigen::Vector2d;

namespace {

const Range PLACE{-1.0, 1.0};
const Range LENGTH{1e-5, 1.0};
const Range ANGLE{-M_PI, M_PI};
const Range DENSITY{1.0, 2.5e4};

Vector2d point(SettingsReader* reader, const std::string& key, const Vector2d& fallback) {
  if (!reader->has(key)) return fallback;
  const auto xy = reader->numbers(key, 2, PLACE, "m");
  return {xy[0], xy[1]};
}

int sense(SettingsReader* reader, const std::string& key) {
  return reader->choice(key, {"counter_clockwise", "clockwise"}) == "clockwise" ? -1 : 1;
}

void readBox(SettingsReader reader, WingBox* box) {
  box->low = point(&reader, "low", box->low);
  box->high = point(&reader, "high", box->high);
  reader.finish();
}

void readLinkage(SettingsReader reader, WingSettings* s) {
  s->auxiliary_joint = point(&reader, "auxiliary_joint", s->auxiliary_joint);
  s->rotation_centre = point(&reader, "rotation_centre", s->rotation_centre);
  s->crank_sign = sense(&reader, "arm_turns");
  s->wing_sign = sense(&reader, "wing_turns");
  s->tip_radius = reader.numberOr("tip_radius", s->tip_radius, {0.01, 1.0}, "m");
  s->tip_direction = reader.numberOr("tip_direction", s->tip_direction, ANGLE, "rad");
  reader.finish();
}

void readLimits(SettingsReader reader, WingSettings* s) {
  s->separation = reader.numberOr("separation", s->separation, LENGTH, "m");
  s->wall_joint2_x = reader.numberOr("wall_joint2_x", s->wall_joint2_x, PLACE, "m");
  s->wall_joint1_y = reader.numberOr("wall_joint1_y", s->wall_joint1_y, PLACE, "m");
  s->transmission_margin = reader.numberOr("transmission_margin", s->transmission_margin, {1e-3, 1.5}, "rad");
  s->min_bar_length = reader.numberOr("min_bar_length", s->min_bar_length, LENGTH, "m");
  if (reader.has("joint1_box")) readBox(reader.map("joint1_box"), &s->joint1_box);
  if (reader.has("joint2_box")) readBox(reader.map("joint2_box"), &s->joint2_box);
  reader.finish();
}

void readObjective(SettingsReader reader, WingSettings* s) {
  s->compliance_weight = reader.numberOr("compliance_weight", s->compliance_weight, {0, 1e6}, "m2/J");
  s->rotation_weight = reader.numberOr("rotation_weight", s->rotation_weight, {0, 10}, "m/rad");
  s->dwell_weight = reader.numberOr("dwell_weight", s->dwell_weight, {0, 10}, "m/rad");
  reader.finish();
}

void readSearch(SettingsReader reader, WingSettings* s) {
  s->samples = reader.integerOr("samples", s->samples, 1, 10000000);
  s->starts = reader.integerOr("starts", s->starts, 1, 10000);
  s->seed = reader.integerOr("seed", s->seed, 0, 2000000000);
  s->evaluations = reader.integerOr("evaluations", s->evaluations, 1, 1000000);
  if (reader.has("optimizer")) s->optimizer = reader.choice("optimizer", {"nlopt_mma", "nlopt_slsqp", "own_mma"});
  reader.finish();
}

void readBars(SettingsReader reader, WingBars* b) {
  b->youngs_modulus = reader.numberOr("youngs_modulus", b->youngs_modulus, {1e3, 1e13}, "Pa");
  b->poisson_ratio = reader.numberOr("poisson_ratio", b->poisson_ratio, {0, 0.499}, "1");
  b->mass_density = reader.numberOr("mass_density", b->mass_density, DENSITY, "kg/m3");
  b->width = reader.numberOr("width", b->width, LENGTH, "m");
  b->thickness = reader.numberOr("thickness", b->thickness, LENGTH, "m");
  b->pin_diameter = reader.numberOr("pin_diameter", b->pin_diameter, LENGTH, "m");
  b->friction_moment = reader.numberOr("friction_moment", b->friction_moment, {0, 10}, "N m");
  b->friction_unevenness = reader.numberOr("friction_unevenness", b->friction_unevenness, {-1, 1}, "1");
  reader.finish();
}

void readBlade(SettingsReader reader, WingBladeSettings* b) {
  b->rod_diameter = reader.numberOr("rod_diameter", b->rod_diameter, LENGTH, "m");
  b->rod_density = reader.numberOr("rod_density", b->rod_density, DENSITY, "kg/m3");
  b->film_thickness = reader.numberOr("film_thickness", b->film_thickness, LENGTH, "m");
  b->film_density = reader.numberOr("film_density", b->film_density, DENSITY, "kg/m3");
  b->rib_width = reader.numberOr("rib_width", b->rib_width, LENGTH, "m");
  b->rib_thickness = reader.numberOr("rib_thickness", b->rib_thickness, LENGTH, "m");
  b->rib_density = reader.numberOr("rib_density", b->rib_density, DENSITY, "kg/m3");
  b->folded_span = reader.numberOr("folded_span", b->folded_span, {0.01, 3.0}, "rad");
  b->slack = reader.numberOr("slack", b->slack, {0, 1.0}, "rad");
  reader.finish();
}

void readStack(SettingsReader reader, WingStackSettings* k) {
  k->most_layers = reader.integerOr("most_layers", k->most_layers, 1, 8);
  k->gap = reader.numberOr("gap", k->gap, {0, 0.1}, "m");
  k->clearance = reader.numberOr("clearance", k->clearance, {0, 0.1}, "m");
  reader.finish();
}

struct CurveStates {
  std::optional<double> second, largest;  ///< [rad]
};

/// A table by its name and contents; where it lies is nobody's business.
std::string tableName(const std::string& path) {
  return "table " + std::filesystem::path(path).filename().string() + ", sha256 " + common::sha256OfFile(path);
}

/// theta(u) from the arm's own table or from points; the driven states of the table where it is one.
CurveStates readMotion(SettingsReader reader, WingSettings* s) {
  CurveStates states;
  if (reader.has("table")) {
    const std::string path = reader.resolvePath(reader.text("table"));
    const double largest = reader.number("largest_travel", {1e-3, 1.0}, "m");
    reader.finish();
    const vehicle::ForceTable table = vehicle::loadForceTable(path);
    const double second = vehicle::curveFeatures(table).second_travel;
    if (!std::isfinite(second)) reader.fail("table", path, "a bistable arm: the curve has no second equilibrium");
    s->motion = ArmMotion::fromTable(table, tableName(path));
    states = {s->motion->rotation(second), s->motion->rotation(largest)};
  } else {
    const auto count = static_cast<std::size_t>(reader.integer("points", 3, 10000));
    const auto travel = reader.numbers("travel", count, {0, 1}, "m");
    const auto rotation = reader.numbers("rotation", count, {0, M_PI}, "rad");
    reader.finish();
    s->motion.emplace(travel, rotation, "points of the settings file");
  }
  return states;
}

void readTargets(SettingsReader* reader, const CurveStates& states, WingSettings* s) {
  auto list = reader->list("targets");
  if (list.size() != 2) reader->fail("targets", std::to_string(list.size()) + " entries", "2 entries");
  for (int i = 0; i < 2; ++i) {
    const auto& own = i == 0 ? states.second : states.largest;
    const Range range{1e-3, M_PI};
    if (own && !list[i].has("arm_rotation")) {
      s->targets[i].arm_rotation = *own;
    } else {
      s->targets[i].arm_rotation = list[i].number("arm_rotation", range, "rad");
    }
    s->targets[i].wing_rotation = list[i].number("wing_rotation", {1e-3, 2 * M_PI}, "rad");
    list[i].finish();
  }
}

void demand(bool good, const std::string& key, double value, const std::string& allowed) {
  if (!good) throw common::SettingError("wing settings", key, std::to_string(value), allowed);
}

}  // namespace

void WingStackSettings::validate() const {
  demand(most_layers >= 1 && most_layers <= 8, "layers.most_layers", most_layers, "1 to 8");
  demand(gap >= 0 && gap <= 0.1, "layers.gap", gap, "0 to 0.1 m");
  demand(clearance >= 0 && clearance <= 0.1, "layers.clearance", clearance, "0 to 0.1 m");
}

Vector2d WingSettings::tipAtRest() const {
  return rotation_centre + tip_radius * Vector2d(std::cos(tip_direction), std::sin(tip_direction));
}

Vector2d WingSettings::tipTarget(int i) const {
  const double direction = tip_direction + wantedRotation(i);
  return rotation_centre + tip_radius * Vector2d(std::cos(direction), std::sin(direction));
}

void WingSettings::validate() const {
  demand(targets[0].arm_rotation > 0, "targets[0].arm_rotation", targets[0].arm_rotation, "above 0 rad");
  demand(targets[1].arm_rotation > targets[0].arm_rotation, "targets[1].arm_rotation", targets[1].arm_rotation,
         "above targets[0].arm_rotation");
  demand(crank_sign == 1 || crank_sign == -1, "linkage.arm_turns", crank_sign, "+1 or -1");
  demand(wing_sign == 1 || wing_sign == -1, "linkage.wing_turns", wing_sign, "+1 or -1");
  for (int k = 0; k < 2; ++k) {
    demand(joint1_box.low[k] < joint1_box.high[k], "limits.joint1_box", joint1_box.low[k], "low below high");
    demand(joint2_box.low[k] < joint2_box.high[k], "limits.joint2_box", joint2_box.low[k], "low below high");
  }
  demand(starts <= samples, "search.starts", starts, "at most search.samples");
  demand(bars.pin_diameter < bars.width, "bars.pin_diameter", bars.pin_diameter, "less than bars.width");
  demand(motion.has_value(), "arm_motion", 0, "an arm motion");
  stack.validate();
  motion->travelAt(targets[1].arm_rotation);
}

WingSettings loadWingSettings(const std::string& path) {
  SettingsReader reader = SettingsReader::fromFile(path);
  WingSettings s;
  s.file = path;
  s.name = reader.text("name");
  s.vehicle_file = reader.resolvePath(reader.text("vehicle"));
  if (reader.has("rung")) s.rung = reader.choice("rung", {"rigid", "elastic", "solid"});
  const CurveStates states = readMotion(reader.map("arm_motion"), &s);
  readTargets(&reader, states, &s);
  readLinkage(reader.map("linkage"), &s);
  if (reader.has("limits")) readLimits(reader.map("limits"), &s);
  if (reader.has("objective")) readObjective(reader.map("objective"), &s);
  if (reader.has("search")) readSearch(reader.map("search"), &s);
  if (reader.has("bars")) readBars(reader.map("bars"), &s.bars);
  if (reader.has("blade")) readBlade(reader.map("blade"), &s.blade);
  if (reader.has("layers")) readStack(reader.map("layers"), &s.stack);
  reader.finish();
  s.named_files = reader.namedFiles();
  s.validate();
  return s;
}

}  // namespace snapwing::design
