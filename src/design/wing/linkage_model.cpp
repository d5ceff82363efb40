#include "snapwing/design/wing/linkage_model.h"

#include <cmath>

namespace snapwing::design {

namespace {

constexpr double FOLLOW_STEP = 0.02;  ///< [rad]

double signOf(double a) { return a > 0 ? 1 : a < 0 ? -1 : 0; }

}  // namespace

std::vector<ElasticState> LinkageModel::trace(const std::vector<double>& thetas) const {
  std::vector<ElasticState> states;
  for (const double theta : thetas) {
    const bool closes = poseAt(layout(), theta).has_value();
    const bool follow = !closes && !states.empty() && states.back().status == ElasticStatus::CONVERGED;
    states.push_back(solve(theta, follow ? &states.back() : nullptr));
  }
  return states;
}

ElasticState LinkageModel::reach(double theta) const {
  if (poseAt(layout(), theta)) return solve(theta);
  const int steps = static_cast<int>(std::ceil(theta / FOLLOW_STEP));
  std::vector<double> thetas;
  for (int k = 0; k <= steps; ++k) thetas.push_back(theta * k / steps);
  return trace(thetas).back();
}

PinMoments frictionAt(const FourBar& layout, const WingBars& bars, double theta) {
  const auto pose = poseAt(layout, theta);
  if (!pose || pose->transmission_sine == 0) return {};
  const double M = bars.friction_moment;
  return {-M * layout.crank_sign, -M * signOf(pose->wing_rate - layout.crank_sign),
          -M * signOf(pose->wing_rate - pose->rocker_rate), -M * signOf(pose->rocker_rate)};
}

}  // namespace snapwing::design
