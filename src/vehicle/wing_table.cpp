#include "snapwing/vehicle/wing_table.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "snapwing/common/error.h"

namespace snapwing::vehicle {

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
  visit("kinetic_mass", "kg", &t->kinetic_mass);
  visit("coupled_mass", "kg", &t->coupled_mass);
  visit("friction_force", "N", &t->friction_force);
  for (std::size_t i = 0; i < t->folds.size(); ++i) {
    const std::string name = "fold" + std::to_string(i + 1);
    visit((name + "_x").c_str(), "m", &t->folds[i].x);
    visit((name + "_y").c_str(), "m", &t->folds[i].y);
    visit((name + "_z").c_str(), "m", &t->folds[i].z);
  }
  visit("axle", "m", &t->axle);
  visit("auxiliary", "m", &t->auxiliary);
}

namespace {

/// What only an elastic rung or a blade can give.
bool columnIsOptional(const std::string& name) {
  static const std::set<std::string> optional = {"stored_energy",  "kinetic_mass", "coupled_mass",
                                                 "friction_force", "axle",         "auxiliary"};
  return optional.count(name) > 0 || name.rfind("fold", 0) == 0;
}

}  // namespace

void WingTable::validate() const {
  WingTable copy = *this;
  const std::size_t size = travel.size();
  if (size < 2) throw common::Error("wing table: " + std::to_string(size) + " points; allowed: at least 2");
  forEachColumn(&copy, [&](const char* name, const char*, std::vector<double>* column) {
    const bool may_be_empty = columnIsOptional(name);
    const bool fixed = column == &copy.axle || column == &copy.auxiliary;
    if (column->size() != (fixed ? 2 : size) && !(may_be_empty && column->empty())) {
      throw common::Error(std::string("wing table: '") + name + "' has " + std::to_string(column->size()) +
                          " entries; allowed: " + std::to_string(fixed ? 2 : size));
    }
    for (const double value : *column) {
      if (!std::isfinite(value)) throw common::Error(std::string("wing table: '") + name + "' is not finite");
    }
  });
  for (std::size_t i = 1; i < size; ++i) {
    if (!(travel[i] > travel[i - 1])) throw common::Error("wing table: 'travel' does not increase");
  }
}

double WingTable::at(const std::vector<double>& column, double u) const {
  const double inside = std::clamp(u, travel.front(), travel.back());
  const auto upper = std::upper_bound(travel.begin() + 1, travel.end() - 1, inside);
  const auto k = static_cast<std::size_t>(upper - travel.begin());
  const double share = (inside - travel[k - 1]) / (travel[k] - travel[k - 1]);
  return column[k - 1] + share * (column[k] - column[k - 1]);
}

void refuseWingsOnBoom(const std::string& who) {
  throw common::Error(who +
                      ": wings are on and the mount is boom, where the centripetal force turns them, which this model "
                      "leaves out; allowed: free, held, wings off, or a trial with freedom: six");
}

}  // namespace snapwing::vehicle
