#include "snapwing/vehicle/motion_columns.h"

#include <cmath>

#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"

namespace snapwing::vehicle {

namespace {

void checkColumn(const std::vector<double>& values, const std::string& name, bool mass, std::size_t points) {
  const std::string column = "force table: 'motion/" + name + "'";
  if (values.size() != points) {
    throw common::Error(column + " has " + std::to_string(values.size()) + " entries, travel has " +
                        std::to_string(points));
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i]) && (mass ? values[i] > 0 : values[i] >= 0)) continue;
    throw common::Error(column + " is " + common::toText(values[i]) + (mass ? " kg" : " N s/m") + " at entry " +
                        std::to_string(i) + "; allowed: " + (mass ? "above 0" : "0 or more"));
  }
}

}  // namespace

void MotionColumns::validate(std::size_t points) const {
  checkColumn(effective_mass, "effective_mass", true, points);
  checkColumn(static_mass, "static_mass", true, points);
  checkColumn(damping, "damping", false, points);
  if (!(std::isfinite(covered_from) && std::isfinite(covered_to) && covered_from < covered_to)) {
    throw common::Error("force table: 'motion/covered' is " + common::toText(covered_from) + " .. " +
                        common::toText(covered_to) + " m; allowed: two travels, the larger one last");
  }
}

}  // namespace snapwing::vehicle
