#include "snapwing/design/wing/wing_blade.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "snapwing/common/error.h"

namespace snapwing::design {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr int SPAN_SAMPLES = 257;

/// Linkage frame (x outward, y up, third out of the plane) to frame "ring".
Vector3d place(const WingLayout& w, const Vector3d& p, WingSide side) {
  const double left = w.axle_radius + p.x();
  return {p.z(), side == WingSide::LEFT ? left : -left, p.y() - w.axle_below_ring};
}

/// Mass, first and second moment about the origin; bodies are added up in these.
struct Moments {
  double mass = 0;
  Vector3d first = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();
  /// Thin rod: integral of x x^T = m / 6 (2 a a^T + 2 b b^T + a b^T + b a^T).
  void addRod(double m, const Vector3d& a, const Vector3d& b) {
    mass += m;
    first += 0.5 * m * (a + b);
    second += m / 6 * (2 * a * a.transpose() + 2 * b * b.transpose() + a * b.transpose() + b * a.transpose());
  }
  /// Thin triangle: integral of x x^T = m / 12 (sum v v^T + (sum v)(sum v)^T).
  void addTriangle(double m, const Triangle& t) {
    const Vector3d sum = t[0] + t[1] + t[2];
    mass += m;
    first += m / 3 * sum;
    Matrix3d all = sum * sum.transpose();
    for (const Vector3d& v : t) all += v * v.transpose();
    second += m / 12 * all;
  }
  void add(double m, const std::vector<Vector3d>& points) {
    if (points.size() == 2) {
      addRod(m, points[0], points[1]);
    } else {
      addTriangle(m, {points[0], points[1], points[2]});
    }
  }
  MassProperties about() const {
    MassProperties p;
    p.mass = mass;
    p.centre = first / mass;
    const Matrix3d central = second - mass * p.centre * p.centre.transpose();
    p.inertia = central.trace() * Matrix3d::Identity() - central;
    return p;
  }
};

double areaOf(const Triangle& t) { return 0.5 * (t[1] - t[0]).cross(t[2] - t[0]).norm(); }

}  // namespace

WingBlade::WingBlade(WingLayout layout) : layout_(std::move(layout)) {
  layout_.validate();
  const TravelCheck check = checkTravel(layout_.linkage, layout_.arm_rotation[1]);
  if (!check.closes) throw common::Error("wing blade: " + check.verdict(0));
  edge_length_ = (layout_.linkage.tip - layout_.linkage.joint2).norm();
  if (!(edge_length_ > 0)) throw common::Error("wing blade: joint 2 and tip coincide; allowed: a leading edge");
  double widest = 0;
  for (int i = 0; i < SPAN_SAMPLES; ++i) {
    const auto pose = design::poseAt(layout_.linkage, layout_.arm_rotation[1] * i / (SPAN_SAMPLES - 1));
    if (pose) widest = std::max(widest, spanAt(*pose));
  }
  panel_angle_ = (widest + layout_.blade.slack) / 4;
  if (!(widest + layout_.blade.slack < 2 * M_PI)) {
    throw common::Error("wing blade: the fan would span " + std::to_string(widest) + " rad; allowed: below 2 pi");
  }
}

double WingBlade::spanAt(const FourBarPose& pose) const {
  const Vector2d edge = pose.tip - pose.joint2, last = layout_.anchor - pose.joint2;
  const double angle = std::atan2(edge.x() * last.y() - edge.y() * last.x(), edge.dot(last)) * layout_.wing_sign;
  // The blade opens on one side of the leading edge only; a little past closed counts as closed.
  return angle > -0.5 ? std::max(angle, 0.0) : angle + 2 * M_PI;
}

std::optional<WingBladePose> WingBlade::poseAt(double theta, WingSide side) const {
  const auto bar = design::poseAt(layout_.linkage, theta);
  if (!bar) return std::nullopt;
  const auto flat = [&](const Vector2d& p) { return place(layout_, {p.x(), p.y(), 0}, side); };
  WingBladePose pose;
  pose.axle = flat(Vector2d::Zero());
  pose.auxiliary = flat(layout_.linkage.auxiliary);
  pose.joint1 = flat(bar->joint1);
  pose.joint2 = flat(bar->joint2);
  pose.tip = flat(bar->tip);
  pose.wing_angle = bar->wing_rotation;
  pose.span = std::min(spanAt(*bar), 4 * panel_angle_);
  const double quarter = pose.span / 4;
  const double rise = std::acos(std::clamp(std::cos(panel_angle_) / std::cos(quarter), -1.0, 1.0));
  const Vector2d edge = bar->tip - bar->joint2;
  const double start = std::atan2(edge.y(), edge.x());
  for (int i = 0; i < 5; ++i) {
    const double angle = start + layout_.wing_sign * quarter * i, up = i % 2 ? rise : 0;
    const Vector3d along(std::cos(up) * std::cos(angle), std::cos(up) * std::sin(angle), std::sin(up));
    pose.edges[i] = place(layout_, Vector3d(bar->joint2.x(), bar->joint2.y(), 0) + edge_length_ * along, side);
  }
  for (int i = 0; i < 4; ++i) pose.panels[i] = {pose.joint2, pose.edges[i], pose.edges[i + 1]};
  return pose;
}

/// A thin rod (two points) or a thin triangle (three).
struct WingBlade::Body {
  double mass = 0;
  std::vector<Vector3d> points;
};

std::vector<WingBlade::Body> WingBlade::bodiesOf(const WingBladePose& pose) const {
  const WingBladeSettings& blade = layout_.blade;
  const WingBars& bars = layout_.bars;
  std::vector<Body> bodies;
  for (const Triangle& panel : pose.panels) {
    const double film = blade.film_density * blade.film_thickness * areaOf(panel);
    bodies.push_back({film, {panel.begin(), panel.end()}});
  }
  const double rib = blade.rib_density * blade.rib_width * blade.rib_thickness * edge_length_;
  for (const int i : {1, 2}) {
    const Vector3d middle = (0.5 * (pose.edges[i] + pose.edges[i + 1]) - pose.joint2).normalized();
    bodies.push_back({rib, {pose.joint2, pose.joint2 + edge_length_ * middle}});
  }
  const double rod = blade.rod_density * M_PI / 4 * blade.rod_diameter * blade.rod_diameter;
  bodies.push_back({rod * edge_length_, {pose.joint2, pose.tip}});
  const double bar = bars.mass_density * bars.width * bars.thickness;
  const std::array<std::pair<Vector3d, Vector3d>, 3> ends{
      {{pose.axle, pose.joint1}, {pose.joint1, pose.joint2}, {pose.auxiliary, pose.joint2}}};
  for (const auto& [a, b] : ends) bodies.push_back({bar * (b - a).norm(), {a, b}});
  return bodies;
}

MassProperties WingBlade::massAt(const WingBladePose& pose) const {
  Moments all;
  for (const Body& body : bodiesOf(pose)) all.add(body.mass, body.points);
  return all.about();
}

double WingBlade::kineticMass(const WingBladePose& at, const WingBladePose& before, const WingBladePose& after,
                              double du) const {
  const std::vector<Body> now = bodiesOf(at), from = bodiesOf(before), to = bodiesOf(after);
  Moments all;  // of the velocities per du/dt, which are linear along rods and triangles as places are
  for (std::size_t i = 0; i < now.size(); ++i) {
    std::vector<Vector3d> rates;
    for (std::size_t k = 0; k < now[i].points.size(); ++k) rates.push_back((to[i].points[k] - from[i].points[k]) / du);
    all.add(now[i].mass, rates);
  }
  return all.second.trace();
}

double WingBlade::massMoment(const WingBladePose& pose) const {
  Moments all;
  for (const Body& body : bodiesOf(pose)) all.add(body.mass, body.points);
  return all.first.z();
}

std::optional<double> WingBlade::frictionForce(double theta, double slope, WingSide side) const {
  const auto pose = design::poseAt(layout_.linkage, theta);
  if (!pose || pose->transmission_sine == 0) return std::nullopt;
  const double crank = layout_.linkage.crank_sign;
  const double turning = 1 + std::abs(pose->wing_rate - crank) + std::abs(pose->wing_rate - pose->rocker_rate) +
                         std::abs(pose->rocker_rate);
  const double uneven = layout_.bars.friction_unevenness * (side == WingSide::LEFT ? 1 : -1);
  return layout_.bars.friction_moment * (1 + uneven) * turning * std::abs(slope);
}

}  // namespace snapwing::design
