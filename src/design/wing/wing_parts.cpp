#include "snapwing/design/wing/wing_parts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <sstream>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"

namespace snapwing::design {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double EDGE_PLATE = 0.040;  ///< [m] overlap with the rod, at most half the leading edge
constexpr double MM = 1e3;
constexpr double STEEL = 7850;  ///< [kg/m3]

void check(const FlatBar& bar) {
  const bool good = bar.width > 0 && bar.thickness > 0 && bar.hole_diameter > 0 && bar.hole_diameter < bar.width &&
                    bar.length > bar.hole_diameter && std::isfinite(bar.length + bar.width + bar.thickness);
  if (!good) {
    throw common::Error("part: bar of length " + std::to_string(bar.length) + " m, width " + std::to_string(bar.width) +
                        " m, hole " + std::to_string(bar.hole_diameter) +
                        " m; allowed: hole narrower than the bar, bar longer than a hole");
  }
}

/// Half of a bar around one hole, star-shaped about it: inner[i] and outer[i] lie on the same ray. Closed rings.
struct Half {
  std::vector<Vector2d> inner, outer;
};

/// Angles of the rays: equal steps, and those to the two corners where the straight sides meet the middle line.
std::vector<double> rays(double corner, int segments) {
  std::vector<double> angles{corner, -corner};
  for (int k = -segments / 2; k < segments / 2; ++k) {
    const double angle = 2 * M_PI * k / segments;
    const bool near = std::abs(std::abs(angle) - corner) < 1e-6;
    if (!near) angles.push_back(angle);
  }
  std::sort(angles.begin(), angles.end());
  return angles;
}

/// The half around the hole at the origin; the middle line is x = length / 2.
Half leftHalf(const FlatBar& bar, int segments) {
  const double r = 0.5 * bar.width, middle = 0.5 * bar.length;
  Half half;
  for (const double angle : rays(std::atan2(r, middle), segments)) {
    const Vector2d ray(std::cos(angle), std::sin(angle));
    double reach = r;
    if (ray.x() > 1e-12) reach = std::min(middle / ray.x(), std::abs(ray.y()) > 1e-12 ? r / std::abs(ray.y()) : 1e9);
    half.inner.emplace_back(0.5 * bar.hole_diameter * ray);
    half.outer.emplace_back(reach * ray);
  }
  return half;
}

class Solid {
 public:
  Solid(double thickness, PartMesh* mesh) : top_(thickness), mesh_(mesh) {}
  /// A face between two rings at top and bottom; flat counter-clockwise quads a, b, c, d.
  void addFaces(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
    add(up(a), up(b), up(c));
    add(up(a), up(c), up(d));
    add(down(a), down(c), down(b));
    add(down(a), down(d), down(c));
  }
  /// A wall above the directed edge a -> b, with the material on its left.
  void addWall(const Vector2d& a, const Vector2d& b) {
    add(down(a), down(b), up(b));
    add(down(a), up(b), up(a));
  }

 private:
  Vector3d up(const Vector2d& p) const { return {p.x(), p.y(), top_}; }
  Vector3d down(const Vector2d& p) const { return {p.x(), p.y(), 0}; }
  void add(const Vector3d& a, const Vector3d& b, const Vector3d& c) { mesh_->triangles.push_back({a, b, c}); }
  double top_;
  PartMesh* mesh_;
};

/// @param flip  turn the half by half a turn about the bar's middle
void addHalf(const Half& half, double length, bool flip, Solid* solid) {
  const auto at = [&](const Vector2d& p) -> Vector2d { return flip ? Vector2d(length - p.x(), -p.y()) : p; };
  const std::size_t n = half.inner.size();
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = (i + 1) % n;
    const Vector2d a = at(half.inner[i]), b = at(half.outer[i]), c = at(half.outer[j]), d = at(half.inner[j]);
    solid->addFaces(a, b, c, d);
    solid->addWall(d, a);
    const double middle = 0.5 * length;
    const bool inside = std::abs(b.x() - middle) < 1e-12 && std::abs(c.x() - middle) < 1e-12;
    if (!inside) solid->addWall(b, c);
  }
}

void code(std::ostream& out, int group, const std::string& value) { out << group << "\n" << value << "\n"; }
void code(std::ostream& out, int group, double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.6f", value);
  code(out, group, std::string(text));
}
void entity(std::ostream& out, const char* kind) {
  code(out, 0, std::string(kind));
  code(out, 8, std::string("CUT"));
}

std::string row(const WingPart& part, double mass, const StackPlan& plan) {
  char text[200];
  const FlatBar& b = part.bar;
  std::snprintf(text, sizeof text, ",%d,%.2f,%.2f,%.2f,%.2f,%.2f,", part.count, MM * b.length, MM * b.width,
                MM * b.thickness, MM * b.hole_diameter, 1e3 * mass);
  const PlacedPiece* piece = plan.find(part.name);
  char place[40] = ",,";
  if (piece != nullptr) std::snprintf(place, sizeof place, "%d,%.2f,", piece->layer, MM * piece->z);
  return part.name + text + place + part.use + "\n";
}

/// Pins of steel. One that the ring holds reaches into it by the thickness of a bar.
std::string pinRows(const WingLayout& w, const StackPlan& plan) {
  const double d = w.bars.pin_diameter;
  const auto pin = [&](const std::string& name, int count, double length, const std::string& use) {
    return row({name, {length, d, d, 0}, count, use}, STEEL * M_PI / 4 * d * d * length, plan);
  };
  if (!plan.found) return pin("pin", 8, 3 * w.bars.thickness, "steel; axle, auxiliary, X1, X2 of both wings");
  std::string rows;
  for (const PlacedPin& p : plan.pins) {
    char use[120];
    std::snprintf(use, sizeof use, "steel; from %.2f to %.2f mm%s", MM * p.low, MM * p.high,
                  p.grounded ? " and into the ring" : "");
    rows += pin("pin_" + p.name, 2, p.high - p.low + (p.grounded ? w.bars.thickness : 0), use);
  }
  return rows;
}

}  // namespace

double PartMesh::volume() const {
  double sum = 0;
  for (const auto& t : triangles) sum += t[0].dot(t[1].cross(t[2])) / 6;
  return sum;
}

std::vector<WingPart> partsOf(const WingLayout& w) {
  const auto bar = [&](double length) { return FlatBar{length, w.bars.width, w.bars.thickness, w.bars.pin_diameter}; };
  const double edge = (w.linkage.tip - w.linkage.joint2).norm();
  return {{"arm_bar", bar(w.linkage.crankLength()), 2, "on the arm: axle to joint X1"},
          {"wing_plate", bar(w.linkage.couplerLength()), 2, "wing: joint X1 to joint X2"},
          {"edge_plate", bar(std::min(EDGE_PLATE, 0.5 * edge)), 2,
           "wing: from joint X2 along the leading edge; fixed at its angle to wing_plate and carries the rod"},
          {"rocker", bar(w.linkage.rockerLength()), 2, "auxiliary joint to joint X2"}};
}

PartMesh meshOf(const FlatBar& bar, int segments) {
  check(bar);
  if (segments < 8 || segments % 4 != 0) {
    throw common::Error("part: " + std::to_string(segments) + " segments; allowed: a multiple of 4, at least 8");
  }
  PartMesh mesh;
  Solid solid(bar.thickness, &mesh);
  const Half half = leftHalf(bar, segments);
  addHalf(half, bar.length, false, &solid);
  addHalf(half, bar.length, true, &solid);
  return mesh;
}

std::string stlOf(const PartMesh& mesh, const std::string& name) {
  std::string out = "solid " + name + "\n";
  char text[240];
  for (const auto& t : mesh.triangles) {
    const Vector3d n = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
    std::snprintf(text, sizeof text, "facet normal %.6f %.6f %.6f\n outer loop\n", n.x(), n.y(), n.z());
    out += text;
    for (const Vector3d& v : t) {
      std::snprintf(text, sizeof text, "  vertex %.6f %.6f %.6f\n", MM * v.x(), MM * v.y(), MM * v.z());
      out += text;
    }
    out += " endloop\nendfacet\n";
  }
  return out + "endsolid " + name + "\n";
}

std::string dxfOf(const FlatBar& bar) {
  check(bar);
  std::ostringstream out;
  const double r = MM * 0.5 * bar.width, length = MM * bar.length;
  code(out, 0, std::string("SECTION"));
  code(out, 2, std::string("ENTITIES"));
  for (const double y : {-r, r}) {
    entity(out, "LINE");
    code(out, 10, 0.0);
    code(out, 20, y);
    code(out, 11, length);
    code(out, 21, y);
  }
  for (const double x : {0.0, length}) {
    entity(out, "ARC");
    code(out, 10, x);
    code(out, 20, 0.0);
    code(out, 40, r);
    code(out, 50, x > 0 ? 270.0 : 90.0);
    code(out, 51, x > 0 ? 90.0 : 270.0);
    entity(out, "CIRCLE");
    code(out, 10, x);
    code(out, 20, 0.0);
    code(out, 40, MM * 0.5 * bar.hole_diameter);
  }
  code(out, 0, std::string("ENDSEC"));
  code(out, 0, std::string("EOF"));
  return out.str();
}

std::string partList(const WingLayout& w, const StackPlan& plan) {
  std::string out = "part,count,length_mm,width_mm,thickness_mm,hole_mm,mass_each_g,layer,z_mm,use\n";
  for (const WingPart& part : partsOf(w)) {
    out += row(part, w.bars.mass_density * meshOf(part.bar).volume(), plan);
  }
  const double edge = (w.linkage.tip - w.linkage.joint2).norm(), d = w.blade.rod_diameter;
  out += row({LEADING_EDGE_ROD, {edge, d, d, 0}, 2, "carbon rod from joint X2 to the tip"},
             w.blade.rod_density * M_PI / 4 * d * d * edge, plan);
  const WingBladeSettings& b = w.blade;
  out += row({"rib", {edge, b.rib_width, b.rib_thickness, w.bars.pin_diameter}, 4, "under panels two and three"},
             b.rib_density * b.rib_width * b.rib_thickness * edge, plan);
  out += pinRows(w, plan);
  char place[120];
  const Vector2d arm = w.linkage.joint2 - w.linkage.joint1, lead = w.linkage.tip - w.linkage.joint2;
  const double angle = std::atan2(arm.x() * lead.y() - arm.y() * lead.x(), arm.dot(lead));
  std::snprintf(place, sizeof place, "# angle from wing_plate to edge_plate at X2: %.2f degrees counter-clockwise\n",
                angle * 180 / M_PI);
  return out + place;
}

void saveParts(const WingLayout& layout, const StackPlan& plan, const std::string& folder) {
  const std::filesystem::path root(folder);
  common::makeFolder(root.string());
  for (const WingPart& part : partsOf(layout)) {
    common::writeFileAtomically((root / (part.name + ".stl")).string(), stlOf(meshOf(part.bar), part.name));
    common::writeFileAtomically((root / (part.name + ".dxf")).string(), dxfOf(part.bar));
  }
  common::writeFileAtomically((root / "parts.csv").string(), partList(layout, plan));
}

}  // namespace snapwing::design
