#include "wing_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "marker_parts.h"

namespace snapwing::nodes {

using geometry_msgs::Point;
using visualization_msgs::Marker;

namespace {

constexpr double PANEL_THICKNESS = 1e-3;  // [m]
constexpr double RIB_WIDTH = 0.003;       // [m]
constexpr double BAR_WIDTH = 0.008;       // [m]
constexpr double PIN_SIZE = 0.010;        // [m]

/// Points of one wing: linkage coordinates to the ring's frame. side  +1 left, -1 right.
class WingPoints {
 public:
  WingPoints(const vehicle::WingTable& table, double travel, int side) : t_(table), u_(travel), side_(side) {}
  Point place(double x, double y, double z) const { return point(z, side_ * (t_.axle[0] + x), t_.axle[1] + y); }
  Point at(const std::vector<double>& x, const std::vector<double>& y) const {
    return place(t_.at(x, u_), t_.at(y, u_), 0);
  }
  Point fold(const vehicle::Fold& f) const { return place(t_.at(f.x, u_), t_.at(f.y, u_), t_.at(f.z, u_)); }

 private:
  const vehicle::WingTable& t_;
  double u_;
  int side_;
};

void addLine(Marker* lines, const Point& a, const Point& b) {
  lines->points.push_back(a);
  lines->points.push_back(b);
}

}  // namespace

double travelOfWingAngle(const vehicle::WingTable& t, double angle) {
  const double wanted = std::copysign(1.0, t.wing_angle.back()) * angle;
  double nearest = t.travel.front(), off = std::abs(t.wing_angle.front() - wanted);
  for (std::size_t k = 0; k + 1 < t.travel.size(); ++k) {
    const double a = t.wing_angle[k], b = t.wing_angle[k + 1];
    const double s = a == b ? 0.0 : std::clamp((wanted - a) / (b - a), 0.0, 1.0);
    const double here = std::abs(a + s * (b - a) - wanted);
    if (here < off) off = here, nearest = t.travel[k] + s * (t.travel[k + 1] - t.travel[k]);
  }
  return nearest;
}

void drawDesignedWings(const vehicle::WingTable& t, const std::array<double, 2>& travel,
                       visualization_msgs::MarkerArray* out) {
  for (const int side : {1, -1}) {
    const int id = side > 0 ? 0 : 2;
    const WingPoints wing(t, travel[side > 0 ? 0 : 1], side);
    const Point joint1 = wing.at(t.joint1_x, t.joint1_y), joint2 = wing.at(t.joint2_x, t.joint2_y);
    std::array<Point, 5> ends{wing.at(t.tip_x, t.tip_y)};
    for (std::size_t i = 0; i < t.folds.size(); ++i) ends[i + 1] = wing.fold(t.folds[i]);
    Marker panels = makeMarker("wings", id, Marker::TRIANGLE_LIST, colour(0.92, 0.94, 0.98));
    Marker ribs = makeMarker("wings", id + 1, Marker::LINE_LIST, colour(0.25, 0.45, 0.75));
    ribs.scale.x = RIB_WIDTH;
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      addPanel(panels, joint2, ends[i], ends[i + 1], PANEL_THICKNESS);
      addLine(&ribs, joint2, ends[i]);
      addLine(&ribs, ends[i], ends[i + 1]);
    }
    addLine(&ribs, joint2, ends.back());
    Marker bars = makeMarker("linkage", id, Marker::LINE_LIST, colour(0.90, 0.45, 0.20));
    bars.scale.x = BAR_WIDTH;
    const Point axle = wing.place(0, 0, 0), auxiliary = wing.place(t.auxiliary[0], t.auxiliary[1], 0);
    addLine(&bars, axle, joint1);
    addLine(&bars, joint1, joint2);
    addLine(&bars, auxiliary, joint2);
    addLine(&bars, joint2, ends[0]);
    Marker pins = makeMarker("linkage", id + 1, Marker::SPHERE_LIST, colour(0.2, 0.2, 0.22));
    pins.scale.x = pins.scale.y = pins.scale.z = PIN_SIZE;
    pins.points = {axle, auxiliary, joint1, joint2};
    for (Marker* marker : {&panels, &ribs, &bars, &pins}) out->markers.push_back(*marker);
  }
}

}  // namespace snapwing::nodes
