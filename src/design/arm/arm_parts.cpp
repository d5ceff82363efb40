#include "snapwing/design/arm/arm_parts.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <sstream>

#include "snapwing/common/elementary.h"
#include "snapwing/common/provenance.h"

namespace snapwing::design {

namespace {

constexpr double MILLIMETRES = 1e3;

std::array<double, 3> normalOf(const SolidMesh& mesh, const std::array<int, 3>& t) {
  const auto &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
  const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  std::array<double, 3> n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  if (length > 0) {
    for (double& x : n) x /= length;
  }
  return n;
}

Loop box(double x, double y, double half_width, double half_height, double angle) {
  Loop loop;
  for (const auto& [sx, sy] : {std::pair{-1., -1.}, {1., -1.}, {1., 1.}, {-1., 1.}}) {
    const double px = x + sx * half_width, py = y + sy * half_height;
    loop.push_back(
        {px * common::cos(angle) - py * common::sin(angle), px * common::sin(angle) + py * common::cos(angle)});
  }
  return loop;
}

}  // namespace

std::string stlOf(const SolidMesh& mesh, const std::string& name) {
  std::string bytes(80, ' ');
  bytes.replace(0, std::min<std::size_t>(name.size(), 79), name.substr(0, 79));
  const auto put = [&](const auto& value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    bytes.append(raw, sizeof value);
  };
  put(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    for (const double x : normalOf(mesh, t)) put(static_cast<float>(x));
    for (const int vertex : t) {
      for (const double x : mesh.vertices[vertex]) put(static_cast<float>(MILLIMETRES * x));
    }
    put(static_cast<std::uint16_t>(0));
  }
  return bytes;
}

std::string dxfOf(const std::vector<Loop>& loops, const std::vector<std::array<double, 3>>& circles) {
  std::ostringstream text;
  text.precision(9);
  text << "0\nSECTION\n2\nENTITIES\n";
  for (const Loop& loop : loops) {
    text << "0\nPOLYLINE\n8\nCUT\n66\n1\n70\n1\n10\n0\n20\n0\n30\n0\n";
    for (const auto& p : loop) {
      text << "0\nVERTEX\n8\nCUT\n10\n" << MILLIMETRES * p[0] << "\n20\n" << MILLIMETRES * p[1] << "\n30\n0\n";
    }
    text << "0\nSEQEND\n8\nCUT\n";
  }
  for (const auto& c : circles) {
    text << "0\nCIRCLE\n8\nCUT\n10\n"
         << MILLIMETRES * c[0] << "\n20\n"
         << MILLIMETRES * c[1] << "\n30\n0\n40\n"
         << MILLIMETRES * c[2] << "\n";
  }
  text << "0\nENDSEC\n0\nEOF\n";
  return text.str();
}

std::string svgOf(const std::vector<Loop>& loops, const std::vector<std::array<double, 3>>& circles) {
  double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9};
  const auto reach = [&](double x, double y, double r) {
    low[0] = std::min(low[0], x - r), high[0] = std::max(high[0], x + r);
    low[1] = std::min(low[1], -y - r), high[1] = std::max(high[1], -y + r);
  };
  std::ostringstream shapes;
  shapes.precision(7);
  shapes << "<path d=\"";
  for (const Loop& loop : loops) {
    const char* verb = "M";
    for (const auto& p : loop) {
      shapes << verb << MILLIMETRES * p[0] << " " << -MILLIMETRES * p[1];
      verb = "L";
      reach(MILLIMETRES * p[0], MILLIMETRES * p[1], 1);
    }
    shapes << "Z";
  }
  shapes << "\" fill=\"none\" stroke=\"red\" stroke-width=\"0.1\"/>\n";
  for (const auto& c : circles) {
    reach(MILLIMETRES * c[0], MILLIMETRES * c[1], MILLIMETRES * c[2] + 1);
    shapes << "<circle cx=\"" << MILLIMETRES * c[0] << "\" cy=\"" << -MILLIMETRES * c[1] << "\" r=\""
           << MILLIMETRES * c[2] << "\" fill=\"none\" stroke=\"red\" stroke-width=\"0.1\"/>\n";
  }
  std::ostringstream text;
  text << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" << high[0] - low[0] << "mm\" height=\""
       << high[1] - low[1] << "mm\" viewBox=\"" << low[0] << " " << low[1] << " " << high[0] - low[0] << " "
       << high[1] - low[1] << "\">\n"
       << shapes.str() << "</svg>\n";
  return text.str();
}

void saveOutline(const ArmShape& shape, const std::string& folder) {
  common::makeFolder(folder);
  common::writeFileAtomically(folder + "/outline.dxf", dxfOf(shape.loops(), {}));
  common::writeFileAtomically(folder + "/outline.svg", svgOf(shape.loops(), {}));
}

ArmPartsReport saveArmParts(const vehicle::Vehicle& vehicle, const ArmShape& shape, const std::string& folder) {
  constexpr double AXLE_HOLE = 0.0015, SCREW_HOLE = 0.0016, CLEARANCE = 0.0002;  // [m]
  common::makeFolder(folder);
  const vehicle::ArmSettings& arm = vehicle.arm;
  const vehicle::Geometry& g = vehicle.geometry;
  ArmPartsReport report;
  const SolidMesh mesh = extrudeArm(arm, shape, arm.leg_width / 40);
  report.volume = mesh.volume();
  report.mass = report.volume * vehicle.material.mass_density.value;
  report.extent = mesh.extent();
  report.triangles = static_cast<int>(mesh.triangles.size());
  report.watertight = mesh.watertight();
  const auto save = [&](const std::string& name, const std::vector<Loop>& loops,
                        const std::vector<std::array<double, 3>>& circles) {
    common::writeFileAtomically(folder + "/" + name + ".dxf", dxfOf(loops, circles));
    common::writeFileAtomically(folder + "/" + name + ".svg", svgOf(loops, circles));
  };
  common::writeFileAtomically(folder + "/arm.stl", stlOf(mesh, vehicle.name + " arm, millimetres"));
  save("arm", shape.loops(), {{arm.pin_x, arm.pin_y, AXLE_HOLE}});
  // The ring carries, at each arm, two screws of the bracket whose axle lies axle_below_ring under it; the housing has
  // a slot for each leg's thickness, as deep as the clamp strip.
  const double outer = g.ring_radius + 0.5 * g.ring_width, inner = g.ring_radius - 0.5 * g.ring_width;
  std::vector<std::array<double, 3>> ring{{0, 0, outer}, {0, 0, inner}}, housing{{0, 0, g.housing_radius}};
  std::vector<Loop> slots;
  for (int k = 0; k < arm.count; ++k) {
    const double angle = 2 * std::acos(-1.0) * k / arm.count;
    for (const double side : {-1.0, 1.0}) {
      const double y = side * (0.5 * arm.bar_thickness + 2 * SCREW_HOLE);
      ring.push_back({g.ring_radius * common::cos(angle) - y * common::sin(angle),
                      g.ring_radius * common::sin(angle) + y * common::cos(angle), SCREW_HOLE});
    }
    slots.push_back(box(g.housing_radius - 0.008, 0, 0.004, 0.5 * arm.leg_thickness + CLEARANCE, angle));
  }
  save("ring", {}, ring);
  save("housing", slots, housing);
  return report;
}

}  // namespace snapwing::design
