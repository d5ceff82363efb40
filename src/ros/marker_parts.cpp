#include "marker_parts.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace snapwing::nodes {

using visualization_msgs::Marker;

std_msgs::ColorRGBA colour(double red, double green, double blue, double alpha) {
  std_msgs::ColorRGBA c;
  c.r = static_cast<float>(red);
  c.g = static_cast<float>(green);
  c.b = static_cast<float>(blue);
  c.a = static_cast<float>(alpha);
  return c;
}

geometry_msgs::Point point(double x, double y, double z) {
  geometry_msgs::Point p;
  p.x = x;
  p.y = y;
  p.z = z;
  return p;
}

std_msgs::ColorRGBA strainColour(double relative_strain) {
  const double s = std::clamp(relative_strain, -1.0, 1.0), a = std::abs(s);
  const std::array<double, 3> rest = {0.93, 0.86, 0.70};
  const std::array<double, 3> end =
      s < 0 ? std::array<double, 3>{0.10, 0.35, 0.90} : std::array<double, 3>{0.90, 0.15, 0.12};
  return colour(rest[0] + a * (end[0] - rest[0]), rest[1] + a * (end[1] - rest[1]), rest[2] + a * (end[2] - rest[2]));
}

Marker makeMarker(const std::string& space, int id, int type, const std_msgs::ColorRGBA& colour) {
  Marker marker;
  marker.ns = space;
  marker.id = id;
  marker.type = type;
  marker.action = Marker::ADD;
  marker.color = colour;
  marker.pose.orientation.w = 1;
  marker.scale.x = marker.scale.y = marker.scale.z = 1;
  return marker;
}

void addTriangle(Marker& list, const geometry_msgs::Point& a, const geometry_msgs::Point& b,
                 const geometry_msgs::Point& c) {
  list.points.push_back(a);
  list.points.push_back(b);
  list.points.push_back(c);
}

void addPanel(Marker& list, const geometry_msgs::Point& a, const geometry_msgs::Point& b, const geometry_msgs::Point& c,
              double thickness) {
  const double ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z, vx = c.x - a.x, vy = c.y - a.y, vz = c.z - a.z;
  const double nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
  const double length = std::max(1e-12, std::sqrt(nx * nx + ny * ny + nz * nz));
  const auto shifted = [&](const geometry_msgs::Point& p, double by) {
    return point(p.x + by * nx / length, p.y + by * ny / length, p.z + by * nz / length);
  };
  const double half = thickness / 2;
  addTriangle(list, shifted(a, half), shifted(b, half), shifted(c, half));
  addTriangle(list, shifted(a, -half), shifted(c, -half), shifted(b, -half));
}

void addWasher(Marker& list, double inner_radius, double outer_radius, double thickness) {
  constexpr int SEGMENTS = 72;
  const auto corner = [&](int i, bool outer, bool top) {
    const double angle = 2 * M_PI * i / SEGMENTS, radius = outer ? outer_radius : inner_radius;
    return point(radius * std::cos(angle), radius * std::sin(angle), (top ? 0.5 : -0.5) * thickness);
  };
  const auto quad = [&list](const geometry_msgs::Point& a, const geometry_msgs::Point& b, const geometry_msgs::Point& c,
                            const geometry_msgs::Point& d) {
    addTriangle(list, a, b, c);
    addTriangle(list, a, c, d);
  };
  for (int i = 0; i < SEGMENTS; ++i) {
    const int j = i + 1;
    quad(corner(i, false, true), corner(i, true, true), corner(j, true, true), corner(j, false, true));
    quad(corner(i, false, false), corner(j, false, false), corner(j, true, false), corner(i, true, false));
    quad(corner(i, true, false), corner(j, true, false), corner(j, true, true), corner(i, true, true));
    quad(corner(i, false, false), corner(i, false, true), corner(j, false, true), corner(j, false, false));
  }
}

}  // namespace snapwing::nodes
