#include "snapwing/design/wing/wing_clearance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace snapwing::design {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr int TRAVEL_SAMPLES = 181;
constexpr int LINE_SAMPLES = 60;
constexpr int PANEL_SAMPLES = 40;  ///< per edge of a triangle

class Discs {
 public:
  Discs(const vehicle::Vehicle& vehicle, double height) : radius_(vehicle.geometry.rotor_radius), height_(height) {
    for (int k = 0; k < vehicle.rotors.count; ++k) {
      const double azimuth = 2 * M_PI * (k + 0.5) / vehicle.rotors.count;
      centres_.push_back(vehicle.geometry.ring_radius * Vector2d(std::cos(azimuth), std::sin(azimuth)));
    }
  }
  double distance(const Vector3d& p) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Vector2d& centre : centres_) {
      const double beyond = std::max(0.0, (p.head<2>() - centre).norm() - radius_);
      least = std::min(least, std::hypot(beyond, p.z() - height_));
    }
    return least;
  }
  double toLine(const Vector3d& a, const Vector3d& b) const {
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= LINE_SAMPLES; ++i) {
      least = std::min(least, distance(a + (b - a) * i / LINE_SAMPLES));
    }
    return least;
  }
  double toPanel(const Triangle& t) const {
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= PANEL_SAMPLES; ++i) {
      for (int j = 0; j <= PANEL_SAMPLES - i; ++j) {
        least = std::min(least, distance(t[0] + (t[1] - t[0]) * i / PANEL_SAMPLES + (t[2] - t[0]) * j / PANEL_SAMPLES));
      }
    }
    return least;
  }

 private:
  double radius_, height_;
  std::vector<Vector2d> centres_;
};

double barsDistance(const Discs& discs, const WingBladePose& pose, const WingLayout& layout) {
  const double half = 0.5 * layout.bars.width;
  return std::min({discs.toLine(pose.axle, pose.joint1) - half, discs.toLine(pose.joint1, pose.joint2) - half,
                   discs.toLine(pose.auxiliary, pose.joint2) - half,
                   discs.toLine(pose.joint2, pose.tip) - 0.5 * layout.blade.rod_diameter});
}

}  // namespace

WingClearance clearanceOf(const WingBlade& blade, const vehicle::Vehicle& vehicle, double rotor_height) {
  const Discs discs(vehicle, rotor_height);
  WingClearance c;
  c.bars = c.blade = std::numeric_limits<double>::infinity();
  for (int i = 0; i < TRAVEL_SAMPLES; ++i) {
    const double theta = blade.layout().arm_rotation[1] * i / (TRAVEL_SAMPLES - 1);
    const auto pose = blade.poseAt(theta, WingSide::LEFT);  // the right wing is its mirror image, and so are the discs
    if (!pose) continue;
    const double bars = barsDistance(discs, *pose, blade.layout());
    if (bars < c.bars) c.bars = bars, c.bars_at = theta;
    for (const Triangle& panel : pose->panels) {
      const double panels = discs.toPanel(panel);
      if (panels < c.blade) c.blade = panels, c.blade_at = theta;
    }
  }
  return c;
}

}  // namespace snapwing::design
