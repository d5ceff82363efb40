#include "snapwing/design/wing/wing_layout.h"

#include <Eigen/Geometry>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"
#include "snapwing/common/require.h"

namespace snapwing::design {

using common::Range;
using common::SettingsReader;
using Eigen::Vector2d;

namespace {

constexpr char FORMAT[] = "snapwing_wing_1";
const Range PLACE{-1.0, 1.0};
const Range POSITIVE{1e-9, 1e13};

std::string pair(const Vector2d& p) {
  std::ostringstream text;
  text << std::setprecision(17) << std::showpoint << "[" << p.x() << ", " << p.y() << "]";
  return text.str();
}

Vector2d readPair(SettingsReader* reader, const std::string& key) {
  const auto xy = reader->numbers(key, 2, PLACE, "m");
  return {xy[0], xy[1]};
}

/// Member, key and unit of every number of the bars and the blade: writing and reading walk the same list.
struct Field {
  const char* key;
  const char* unit;
  double* value;
};
std::vector<Field> fieldsOf(WingBars* b) {
  return {{"youngs_modulus", "Pa", &b->youngs_modulus},
          {"poisson_ratio", "1", &b->poisson_ratio},
          {"mass_density", "kg/m3", &b->mass_density},
          {"width", "m", &b->width},
          {"thickness", "m", &b->thickness},
          {"pin_diameter", "m", &b->pin_diameter},
          {"friction_moment", "N m", &b->friction_moment},
          {"friction_unevenness", "1", &b->friction_unevenness}};
}
std::vector<Field> fieldsOf(WingBladeSettings* b) {
  return {{"rod_diameter", "m", &b->rod_diameter},
          {"rod_density", "kg/m3", &b->rod_density},
          {"film_thickness", "m", &b->film_thickness},
          {"film_density", "kg/m3", &b->film_density},
          {"rib_width", "m", &b->rib_width},
          {"rib_thickness", "m", &b->rib_thickness},
          {"rib_density", "kg/m3", &b->rib_density},
          {"folded_span", "rad", &b->folded_span},
          {"slack", "rad", &b->slack}};
}

template <class T>
void writeFields(std::ostream& out, const char* name, T values) {
  out << name << ":\n";
  for (const Field& f : fieldsOf(&values)) out << "  " << f.key << ": " << *f.value << "  # [" << f.unit << "]\n";
}

template <class T>
void readFields(SettingsReader reader, T* values) {
  for (const Field& f : fieldsOf(values)) *f.value = reader.number(f.key, {0, POSITIVE.high}, f.unit);
  reader.finish();
}

void writeResults(std::ostream& out, const WingSettings& s, const WingDesign& d) {
  out << "results:\n  status: " << nameOf(d.status) << "\n  message: \"" << d.message << "\"\n";
  out << "  objective: " << d.objective << "  # [m2]\n";
  out << "  smallest_transmission_angle: " << d.travel.smallest_transmission << "  # [rad]\n";
  out << "  separation: " << d.separation << "  # [m] s1 is " << s.separation << "\n";
  out << "  joint2_x: " << d.joint2_x << "  # [m] s2 is " << s.wall_joint2_x << "\n";
  out << "  joint1_y: " << d.joint1_y << "  # [m] s3 is " << s.wall_joint1_y << "\n";
  out << "  samples: " << d.samples << "\n  runs: " << d.runs << "\n  evaluations: " << d.evaluations
      << "\n  states:\n";
  for (int i = 0; i < 2; ++i) {
    const WingState& state = d.states[i];
    out << "    - {arm_rotation: " << state.arm_rotation << ", wing_rotation: " << state.pose.wing_rotation
        << ", wanted_rotation: " << s.wantedRotation(i) << ", tip: " << pair(state.pose.tip)
        << ", tip_target: " << pair(state.target) << ", tip_residual: " << state.tip_residual << "}\n";
  }
}

/// Under "results": what the layers are, or why there are none.
void writeLayers(std::ostream& out, const StackPlan& stack) {
  out << "  layers:  # from the ring outward; z of lower faces and pins' ends over the ring's side [m]\n";
  out << "    found: " << (stack.found ? "true" : "false") << "\n    message: \"" << stack.message << "\"\n";
  if (!stack.found) return;
  out << "    pieces:\n";
  for (const PlacedPiece& p : stack.pieces) {
    out << "      - {name: " << p.name << ", layer: " << p.layer << ", z: " << p.z << "}\n";
  }
  out << "    pins:\n";
  for (const PlacedPin& p : stack.pins) {
    out << "      - {name: " << p.name << ", from: " << p.low << ", to: " << p.high << "}\n";
  }
}

const common::Require require("wing");

}  // namespace

void WingLayout::validate() const {
  linkage.validate();
  require(wing_sign == 1 || wing_sign == -1, "wing_sign", wing_sign, "1, -1");
  require(arm_rotation[0] > 0 && arm_rotation[1] > arm_rotation[0], "arm_rotation[0]", arm_rotation[0],
          "above 0 and below arm_rotation[1]");
  require(anchor.allFinite(), "anchor", anchor.sum(), "finite");
  require(axle_radius >= 0 && std::isfinite(axle_radius), "axle_radius", axle_radius, "at least 0 m");
  require(std::isfinite(axle_below_ring), "axle_below_ring", axle_below_ring, "finite");
}

WingLayout layoutOf(const WingSettings& s, const WingDesign& d, const vehicle::Vehicle& vehicle,
                    const std::string& rung) {
  if (d.status != WingStatus::DESIGNED) throw common::Error("wing: the design is not finished: " + d.message);
  WingLayout w;
  w.name = s.name;
  w.rung = rung;
  w.linkage = d.linkage;
  w.wing_sign = s.wing_sign;
  w.arm_rotation = {s.targets[0].arm_rotation, s.targets[1].arm_rotation};
  const FourBarPose& folded = d.states[1].pose;
  w.anchor = folded.joint2 + Eigen::Rotation2Dd(s.wing_sign * s.blade.folded_span) * (folded.tip - folded.joint2);
  w.axle_radius = vehicle.geometry.housing_radius + vehicle.arm.pin_x;
  w.axle_below_ring = vehicle.geometry.axle_below_ring;
  w.bars = s.bars;
  w.blade = s.blade;
  w.validate();
  return w;
}

void saveWing(const WingLayout& w, const WingSettings& s, const WingDesign& d, const StackPlan& stack,
              const std::string& path) {
  std::ostringstream out;
  out << std::setprecision(17) << std::showpoint;
  out << "# A designed wing. Frame: origin at the arm's axle, x outward, y up; SI and radians.\n";
  out << "format: " << FORMAT << "\nname: " << w.name << "\nrung: " << w.rung << "\nlinkage:\n";
  out << "  auxiliary_joint: " << pair(w.linkage.auxiliary) << "\n  joint1: " << pair(w.linkage.joint1)
      << "\n  joint2: " << pair(w.linkage.joint2) << "\n  tip: " << pair(w.linkage.tip)
      << "\n  crank_sign: " << w.linkage.crank_sign << "\n  wing_sign: " << w.wing_sign << "\n";
  out << "  arm_rotation: [" << w.arm_rotation[0] << ", " << w.arm_rotation[1] << "]\n";
  out << "place:\n  anchor: " << pair(w.anchor) << "\n  axle_radius: " << w.axle_radius
      << "\n  axle_below_ring: " << w.axle_below_ring << "\n";
  writeFields(out, "bars", w.bars);
  writeFields(out, "blade", w.blade);
  writeResults(out, s, d);
  writeLayers(out, stack);
  out << "provenance:\n  snapwing_version: \"" << common::version() << "\"\n";
  if (!s.file.empty()) out << "  settings_sha256: \"" << common::sha256OfFile(s.file) << "\"\n";
  out << "  arm_motion: \"" << s.motion->source() << "\"\n";
  common::writeFileAtomically(path, out.str());
}

WingLayout loadWing(const std::string& path) {
  SettingsReader reader = SettingsReader::fromFile(path);
  reader.choice("format", {FORMAT});
  WingLayout w;
  w.name = reader.text("name");
  w.rung = reader.choice("rung", {"rigid", "elastic", "solid"});
  SettingsReader linkage = reader.map("linkage");
  w.linkage.auxiliary = readPair(&linkage, "auxiliary_joint");
  w.linkage.joint1 = readPair(&linkage, "joint1");
  w.linkage.joint2 = readPair(&linkage, "joint2");
  w.linkage.tip = readPair(&linkage, "tip");
  w.linkage.crank_sign = linkage.integer("crank_sign", -1, 1);
  w.wing_sign = linkage.integer("wing_sign", -1, 1);
  const auto rotations = linkage.numbers("arm_rotation", 2, {0, M_PI}, "rad");
  w.arm_rotation = {rotations[0], rotations[1]};
  linkage.finish();
  SettingsReader place = reader.map("place");
  w.anchor = readPair(&place, "anchor");
  w.axle_radius = place.number("axle_radius", {0, 10}, "m");
  w.axle_below_ring = place.number("axle_below_ring", {-1, 1}, "m");
  place.finish();
  readFields(reader.map("bars"), &w.bars);
  readFields(reader.map("blade"), &w.blade);
  reader.map("results");
  reader.map("provenance");
  reader.finish();
  w.validate();
  return w;
}

}  // namespace snapwing::design
