#include "snapwing/design/wing_table.h"

#include <algorithm>
#include <cmath>

#include "snapwing/common/error.h"

namespace snapwing::design {

void forEachColumn(WingTable* t, const std::function<void(const char*, const char*, std::vector<double>*)>& visit) {
  visit("travel", "m", &t->travel);
  visit("arm_rotation", "rad", &t->arm_rotation);
  visit("wing_angle", "rad", &t->wing_angle);
  visit("rocker_angle", "rad", &t->rocker_angle);
  visit("joint1_x", "m", &t->joint1_x);
  visit("joint1_y", "m", &t->joint1_y);
  visit("joint2_x", "m", &t->joint2_x);
  visit("joint2_y", "m", &t->joint2_y);
  visit("tip_x", "m", &t->tip_x);
  visit("tip_y", "m", &t->tip_y);
  visit("transmission_ratio", "1", &t->transmission_ratio);
  visit("angle_per_travel", "rad/m", &t->angle_per_travel);
  visit("transmission_angle", "rad", &t->transmission_angle);
  visit("stored_energy", "J", &t->stored_energy);
}

void WingTable::validate() const {
  WingTable copy = *this;
  const std::size_t size = travel.size();
  if (size < 2) throw common::Error("wing table: " + std::to_string(size) + " points; allowed: at least 2");
  forEachColumn(&copy, [&](const char* name, const char*, std::vector<double>* column) {
    const bool may_be_empty = column == &copy.stored_energy;
    if (column->size() != size && !(may_be_empty && column->empty())) {
      throw common::Error(std::string("wing table: '") + name + "' has " + std::to_string(column->size()) +
                          " entries; allowed: " + std::to_string(size));
    }
    for (const double value : *column) {
      if (!std::isfinite(value)) throw common::Error(std::string("wing table: '") + name + "' is not finite");
    }
  });
  for (std::size_t i = 1; i < size; ++i) {
    if (!(travel[i] > travel[i - 1])) throw common::Error("wing table: 'travel' does not increase");
  }
}

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

}  // namespace snapwing::design
