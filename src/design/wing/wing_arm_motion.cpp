#include "snapwing/design/wing/wing_arm_motion.h"

#include <algorithm>
#include <cmath>

#include "snapwing/common/error.h"

namespace snapwing::design {

namespace {

void check(const std::vector<double>& travel, const std::vector<double>& rotation) {
  if (travel.size() != rotation.size() || travel.size() < 3) {
    throw common::Error("arm motion: " + std::to_string(travel.size()) + " travels and " +
                        std::to_string(rotation.size()) + " rotations; allowed: as many of both, at least 3");
  }
  for (std::size_t i = 0; i < travel.size(); ++i) {
    const std::string at = "[" + std::to_string(i) + "]";
    if (!std::isfinite(travel[i]) || (i > 0 && !(travel[i] > travel[i - 1]))) {
      throw common::Error("arm motion: travel" + at + " is " + std::to_string(travel[i]) +
                          " m; allowed: finite and above the one before");
    }
    if (!std::isfinite(rotation[i])) throw common::Error("arm motion: rotation" + at + " is not finite");
  }
  if (std::abs(rotation[0]) > 1e-9 || std::abs(travel[0]) > 1e-12) {
    throw common::Error("arm motion: starts at u = " + std::to_string(travel[0]) + " m with " +
                        std::to_string(rotation[0]) + " rad; allowed: 0 m with 0 rad (rest)");
  }
}

/// Slope at an end from a parabola through three points, kept from overshooting.
double endSlope(double h0, double h1, double d0, double d1) {
  const double slope = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
  if (slope * d0 <= 0) return 0;
  return d0 * d1 <= 0 && std::abs(slope) > 3 * std::abs(d0) ? 3 * d0 : slope;
}

}  // namespace

ArmMotion::ArmMotion(std::vector<double> travel, std::vector<double> rotation, std::string source)
    : travel_(std::move(travel)), rotation_(std::move(rotation)), source_(std::move(source)) {
  check(travel_, rotation_);
  const std::size_t n = travel_.size();
  std::vector<double> h(n - 1), d(n - 1);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    h[i] = travel_[i + 1] - travel_[i];
    d[i] = (rotation_[i + 1] - rotation_[i]) / h[i];
  }
  slope_.assign(n, 0.0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    if (d[i - 1] * d[i] <= 0) continue;  // an extreme of the data is an extreme of the curve
    const double w0 = 2 * h[i] + h[i - 1], w1 = h[i] + 2 * h[i - 1];
    slope_[i] = (w0 + w1) / (w0 / d[i - 1] + w1 / d[i]);
  }
  slope_[0] = endSlope(h[0], h[1], d[0], d[1]);
  slope_[n - 1] = endSlope(h[n - 2], h[n - 3], d[n - 2], d[n - 3]);
}

ArmMotion ArmMotion::fromTable(const vehicle::ForceTable& table, const std::string& source) {
  std::vector<double> travel, rotation;
  for (std::size_t i = 0; i < table.travel.size(); ++i) {
    if (table.travel[i] < -1e-12) continue;
    travel.push_back(table.travel[i]);
    rotation.push_back(table.rotation[i]);
  }
  return ArmMotion(std::move(travel), std::move(rotation), source);
}

std::size_t ArmMotion::segment(double u) const {
  // A little slack for travels that were computed; beyond it the curve is unknown.
  const double slack = 1e-9;
  if (!(u >= travel_.front() - slack && u <= travel_.back() + slack)) {
    throw common::Error("arm motion: travel " + std::to_string(u) + " m; allowed: 0 to " +
                        std::to_string(travel_.back()) + " m");
  }
  const auto above = std::upper_bound(travel_.begin() + 1, travel_.end() - 1, u);
  return static_cast<std::size_t>(above - travel_.begin()) - 1;
}

double ArmMotion::rotation(double u) const {
  const std::size_t i = segment(u);
  const double h = travel_[i + 1] - travel_[i], t = (u - travel_[i]) / h;
  const double smooth = t * t * (3 - 2 * t);
  return rotation_[i] * (1 - smooth) + rotation_[i + 1] * smooth +
         h * t * (1 - t) * (slope_[i] * (1 - t) - slope_[i + 1] * t);
}

double ArmMotion::slope(double u) const {
  const std::size_t i = segment(u);
  const double h = travel_[i + 1] - travel_[i], t = (u - travel_[i]) / h;
  return 6 * t * (1 - t) * (rotation_[i + 1] - rotation_[i]) / h + slope_[i] * (1 - t) * (1 - 3 * t) +
         slope_[i + 1] * t * (3 * t - 2);
}

double ArmMotion::travelAt(double theta) const {
  for (std::size_t i = 0; i + 1 < travel_.size(); ++i) {
    if ((rotation_[i] - theta) * (rotation_[i + 1] - theta) > 0) continue;
    double low = travel_[i], high = travel_[i + 1];
    const bool rising = rotation_[i] <= rotation_[i + 1];
    for (int k = 0; k < 200 && high - low > 1e-15; ++k) {
      const double middle = 0.5 * (low + high);
      ((rotation(middle) < theta) == rising ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }
  throw common::Error("arm motion: the rotation " + std::to_string(theta) + " rad is not reached within the travel (" +
                      source_ + ")");
}

}  // namespace snapwing::design
