#include "vehicle_picture.h"

#include <algorithm>
#include <cmath>

#include "marker_parts.h"
#include "wing_picture.h"

namespace snapwing::nodes {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

namespace {

constexpr double PI = 3.14159265358979323846;
constexpr double LABEL_HEIGHT = 0.27;   // [m] over the ring
constexpr double FULL_ARROW = 0.16;     // [m] arrow of full thrust
constexpr double GHOST_LIFE = 0.3;      // [s]
constexpr double ROTOR_HEIGHT = 0.028;  // [m] propeller over the ring

std_msgs::ColorRGBA modeColour(vehicle::Mode mode) {
  if (mode == vehicle::Mode::FIXED_WING) return colour(0.25, 0.65, 1.0);
  if (mode == vehicle::Mode::QUADROTOR) return colour(1.0, 0.62, 0.15);
  return colour(0.8, 0.8, 0.8);
}

double mix(double a, double b, double s) { return a + s * (b - a); }

void fade(MarkerArray& markers, double alpha) {
  for (Marker& marker : markers.markers) {
    marker.color.a = static_cast<float>(marker.color.a * alpha);
    for (std_msgs::ColorRGBA& one : marker.colors) one.a = static_cast<float>(one.a * alpha);
  }
}

}  // namespace

VehiclePicture::VehiclePicture(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table,
                               const PictureSettings& settings)
    : vehicle_(vehicle), settings_(settings), rest_(table.shapes.rest) {
  for (std::size_t k = 0; k < table.shapes.moved.size(); ++k) {
    shapes_.push_back({table.travel[k], table.shapes.moved[k], triangulate(table.shapes.moved[k])});
  }
}

double VehiclePicture::housingHeight(double travel) const {
  const vehicle::ArmSettings& arm = vehicle_.arm;
  const double clamp = 0.5 * (arm.clamp_y_low + arm.clamp_y_high);
  return -vehicle_.geometry.axle_below_ring + clamp - arm.pin_y - travel;
}

std::size_t VehiclePicture::nearest(double travel) const {
  std::size_t best = 0;
  for (std::size_t k = 1; k < shapes_.size(); ++k) {
    if (std::abs(shapes_[k].travel - travel) < std::abs(shapes_[best].travel - travel)) best = k;
  }
  return best;
}

std::vector<Loop> VehiclePicture::outline(double travel) const {
  if (shapes_.empty()) return {};
  std::size_t k = 0;
  while (k + 2 < shapes_.size() && shapes_[k + 1].travel < travel) ++k;
  if (shapes_.size() == 1) return shapes_[0].loops;
  const Shape &a = shapes_[k], &b = shapes_[k + 1];
  const double s = std::clamp((travel - a.travel) / (b.travel - a.travel), 0.0, 1.0);
  std::vector<Loop> loops = a.loops;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    for (std::size_t j = 0; j < loops[i].size(); ++j) {
      for (std::size_t d = 0; d < 2; ++d) loops[i][j][d] = mix(a.loops[i][j][d], b.loops[i][j][d], s);
    }
  }
  return loops;
}

std::vector<std::vector<double>> VehiclePicture::outlineStrain(const std::vector<Loop>& moved) const {
  constexpr std::size_t REACH = 4;  // points on either side: single edges of an outline are too short to tell
  std::vector<std::vector<double>> strain;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const std::size_t n = moved[i].size();
    strain.emplace_back(n, 0.0);
    for (std::size_t j = 0; j < n; ++j) {
      double before = 0, after = 0;
      for (std::size_t e = 0; e < 2 * REACH; ++e) {
        const std::size_t a = (j + n * REACH - REACH + e) % n, b = (a + 1) % n;
        before += std::hypot(rest_[i][a][0] - rest_[i][b][0], rest_[i][a][1] - rest_[i][b][1]);
        after += std::hypot(moved[i][a][0] - moved[i][b][0], moved[i][a][1] - moved[i][b][1]);
      }
      if (before > 0) strain[i][j] = after / before - 1;
    }
  }
  return strain;
}

geometry_msgs::Point VehiclePicture::place(double azimuth, double x, double y, double across) const {
  const double radius = vehicle_.geometry.housing_radius + x;
  return point(radius * std::cos(azimuth) - across * std::sin(azimuth),
               radius * std::sin(azimuth) + across * std::cos(azimuth),
               y - vehicle_.arm.pin_y - vehicle_.geometry.axle_below_ring);
}

MarkerArray VehiclePicture::draw(const PictureState& state) const {
  MarkerArray out;
  drawFrame(out, state);
  drawRotors(out, state);
  drawMoving(out, state);
  fade(out, state.alpha);
  if (std::isfinite(state.ghost_travel)) drawGhost(out, state);
  drawLabel(out, state);
  for (Marker& marker : out.markers) {
    marker.header.stamp = state.stamp;
    if (marker.header.frame_id.empty()) marker.header.frame_id = settings_.ring_frame;
  }
  return out;
}

void VehiclePicture::drawMoving(MarkerArray& out, const PictureState& state) const {
  drawArms(out, state);
  if (!wing_) return;
  const auto orTravel = [&](double u) { return std::isnan(u) ? state.travel : u; };
  drawDesignedWings(*wing_, {orTravel(state.wing_left), orTravel(state.wing_right)}, &out);
}

void VehiclePicture::drawGhost(MarkerArray& out, const PictureState& state) const {
  const vehicle::Geometry& g = vehicle_.geometry;
  PictureState other = state;
  other.travel = state.ghost_travel;
  other.wing_left = other.wing_right = NAN;
  MarkerArray ghost;
  drawMoving(ghost, other);
  Marker housing = makeMarker("housing", 0, Marker::CYLINDER, colour(0.36, 0.39, 0.45));
  housing.pose.position.z = housingHeight(other.travel);  // the housing's frame shows the likelier mode
  housing.scale.x = housing.scale.y = 2 * g.housing_radius;
  housing.scale.z = g.housing_height;
  ghost.markers.push_back(housing);
  fade(ghost, 0.5 * state.alpha);
  for (Marker& marker : ghost.markers) {
    marker.ns = "ghost " + marker.ns;
    marker.lifetime = ros::Duration(GHOST_LIFE);
    out.markers.push_back(marker);
  }
}

void VehiclePicture::drawFrame(MarkerArray& out, const PictureState&) const {
  const vehicle::Geometry& g = vehicle_.geometry;
  Marker ring = makeMarker("ring", 0, Marker::TRIANGLE_LIST, colour(0.72, 0.76, 0.82));
  addWasher(ring, g.ring_radius - g.ring_width / 2, g.ring_radius + g.ring_width / 2, g.ring_thickness);
  out.markers.push_back(ring);

  Marker housing = makeMarker("housing", 0, Marker::CYLINDER, colour(0.36, 0.39, 0.45));
  housing.header.frame_id = settings_.housing_frame;
  housing.scale.x = housing.scale.y = 2 * g.housing_radius;
  housing.scale.z = g.housing_height;
  out.markers.push_back(housing);
  Marker battery = makeMarker("housing", 1, Marker::CUBE, colour(0.95, 0.78, 0.18));
  battery.header.frame_id = settings_.housing_frame;
  battery.scale.x = 1.3 * g.housing_radius;
  battery.scale.y = 0.7 * g.housing_radius;
  battery.scale.z = 0.02;
  battery.pose.position.z = g.housing_height / 2 + 0.01;
  out.markers.push_back(battery);
}

void VehiclePicture::drawRotors(MarkerArray& out, const PictureState& state) const {
  const vehicle::Geometry& g = vehicle_.geometry;
  for (int k = 0; k < vehicle_.rotors.count; ++k) {
    const double azimuth = 2 * PI * (k + 0.5) / vehicle_.rotors.count;
    const double x = g.ring_radius * std::cos(azimuth), y = g.ring_radius * std::sin(azimuth);
    Marker motor = makeMarker("rotors", 2 * k, Marker::CYLINDER, colour(0.35, 0.37, 0.42));
    motor.pose.position = point(x, y, ROTOR_HEIGHT / 2);
    motor.scale.x = motor.scale.y = 0.026;
    motor.scale.z = ROTOR_HEIGHT;
    out.markers.push_back(motor);
    Marker disc = makeMarker("rotors", 2 * k + 1, Marker::CYLINDER, colour(0.55, 0.8, 0.95, 0.22));
    disc.pose.position = point(x, y, ROTOR_HEIGHT);
    disc.scale.x = disc.scale.y = 2 * g.rotor_radius;
    disc.scale.z = 0.003;
    out.markers.push_back(disc);

    const double share =
        static_cast<std::size_t>(k) < state.thrust.size() ? state.thrust[static_cast<std::size_t>(k)] : 0;
    Marker arrow = makeMarker("thrust", k, Marker::ARROW, colour(0.2, 0.9, 0.35));
    arrow.points = {point(x, y, ROTOR_HEIGHT), point(x, y, ROTOR_HEIGHT + FULL_ARROW * share)};
    arrow.scale.x = 0.012;
    arrow.scale.y = 0.03;
    arrow.scale.z = 0.03 * std::min(1.0, 4 * share);
    if (share < 0.005) arrow.action = Marker::DELETE;
    out.markers.push_back(arrow);
  }
}

void VehiclePicture::drawArms(MarkerArray& out, const PictureState& state) const {
  if (shapes_.empty()) return;
  const std::vector<Loop> loops = outline(state.travel);
  const std::vector<std::vector<double>> strain = outlineStrain(loops);
  const auto& triangles = shapes_[nearest(state.travel)].triangles;
  const vehicle::ArmSettings& arm = vehicle_.arm;
  for (int k = 0; k < arm.count; ++k) {
    const double azimuth = 2 * PI * k / arm.count;
    Marker marker = makeMarker("arms", k, Marker::TRIANGLE_LIST, colour(1, 1, 1));
    const auto corner = [&](const VertexId& id, int side) {
      const Point2& p = loops[id.loop][id.point];
      const bool leg = rest_[id.loop][id.point][0] < arm.leg_width;
      marker.points.push_back(place(azimuth, p[0], p[1], side * 0.5 * (leg ? arm.leg_thickness : arm.bar_thickness)));
      marker.colors.push_back(strainColour(strain[id.loop][id.point] / settings_.strain_scale));
    };
    for (const int side : {-1, 1}) {
      for (const auto& triangle : triangles) {
        for (int c = 0; c < 3; ++c) corner(triangle[static_cast<std::size_t>(side > 0 ? c : 2 - c)], side);
      }
    }
    for (std::size_t i = 0; i < loops.size(); ++i) {
      for (std::size_t j = 0; j < loops[i].size(); ++j) {
        const VertexId a{i, j}, b{i, (j + 1) % loops[i].size()};
        corner(a, 1), corner(a, -1), corner(b, -1);
        corner(a, 1), corner(b, -1), corner(b, 1);
      }
    }
    out.markers.push_back(marker);
  }
}

void VehiclePicture::drawLabel(MarkerArray& out, const PictureState& state) const {
  Marker label = makeMarker("label", 0, Marker::TEXT_VIEW_FACING, modeColour(state.mode));
  label.pose.position.z = LABEL_HEIGHT;
  label.scale.z = 0.036;
  label.text = state.label;
  out.markers.push_back(label);
}

}  // namespace snapwing::nodes
