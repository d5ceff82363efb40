#include "snapwing/design/wing/wing_table.h"

#include <algorithm>
#include <cmath>

#include "snapwing/common/error.h"

namespace snapwing::design {

std::optional<WingTable> tabulate(const FourBar& bar, const ArmMotion& motion, double largest, int points) {
  if (points < 2) throw common::Error("wing table: " + std::to_string(points) + " points; allowed: at least 2");
  WingTable t;
  for (int i = 0; i < points; ++i) {
    const double u = largest * i / (points - 1), theta = motion.rotation(u);
    const auto pose = poseAt(bar, theta);
    if (!pose || pose->transmission_sine == 0) return std::nullopt;
    t.travel.push_back(u);
    t.arm_rotation.push_back(theta);
    t.wing_angle.push_back(pose->wing_rotation);
    t.rocker_angle.push_back(pose->rocker_rotation);
    t.joint1_x.push_back(pose->joint1.x());
    t.joint1_y.push_back(pose->joint1.y());
    t.joint2_x.push_back(pose->joint2.x());
    t.joint2_y.push_back(pose->joint2.y());
    t.tip_x.push_back(pose->tip.x());
    t.tip_y.push_back(pose->tip.y());
    t.transmission_ratio.push_back(pose->wing_rate);
    t.angle_per_travel.push_back(pose->wing_rate * motion.slope(u));
    t.transmission_angle.push_back(std::asin(std::min(1.0, std::abs(pose->transmission_sine))));
  }
  t.provenance = {{"rung", "rigid"}, {"arm_motion", motion.source()}, {"stored_energy", "none: rigid bars store none"}};
  t.validate();
  return t;
}

void addBlade(const WingBlade& blade, const ArmMotion& motion, WingTable* table) {
  const WingLayout& layout = blade.layout();
  table->axle = {layout.axle_radius, -layout.axle_below_ring};
  table->auxiliary = {layout.linkage.auxiliary.x(), layout.linkage.auxiliary.y()};
  constexpr double STEP = 1e-5;  // [m] of u, for velocities
  for (const double u : table->travel) {
    const auto pose = blade.poseAt(motion.rotation(u), WingSide::LEFT);
    const double low = std::max(0.0, u - STEP), high = std::min(motion.largestTravel(), u + STEP);
    const auto before = blade.poseAt(motion.rotation(low), WingSide::LEFT),
               after = blade.poseAt(motion.rotation(high), WingSide::LEFT);
    if (!pose || !before || !after) throw common::Error("wing table: the loop opens at u = " + std::to_string(u));
    for (std::size_t i = 0; i < table->folds.size(); ++i) {
      const Eigen::Vector3d& end = pose->edges[i + 1];  // frame "ring", left wing: (out of plane, outward, up)
      table->folds[i].x.push_back(end.y() - layout.axle_radius);
      table->folds[i].y.push_back(end.z() + layout.axle_below_ring);
      table->folds[i].z.push_back(end.x());
    }
    table->kinetic_mass.push_back(2 * blade.kineticMass(*pose, *before, *after, high - low));
    table->coupled_mass.push_back(2 * (blade.massMoment(*after) - blade.massMoment(*before)) / (high - low));
    double friction = 0;
    for (const WingSide side : {WingSide::LEFT, WingSide::RIGHT}) {
      friction += blade.frictionForce(motion.rotation(u), motion.slope(u), side).value_or(0);
    }
    table->friction_force.push_back(friction);
  }
  table->validate();
}

}  // namespace snapwing::design
