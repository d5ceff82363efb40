#include "parameter_cloud.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace snapwing::planning {

namespace {
using P = vehicle::VehicleParameters;
constexpr std::array<double P::*, 16> FIELDS = {
    &P::ring_mass,  &P::centre_mass,      &P::force_scale,        &P::damping,
    &P::max_thrust, &P::time_constant_up, &P::time_constant_down, &P::quadratic_share,
    &P::latency,    &P::ring_drag,        &P::centre_drag,        &P::boom_mass,
    &P::boom_drag,  &P::boom_friction,    &P::wing_inertia,       &P::wing_friction};
constexpr double SHRINK = 0.98;
}  // namespace

ParameterCloud::ParameterCloud(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table, int count,
                               RandomSource& random) {
  std::vector<double> xi(vehicle::uncertainNames().size());
  for (int i = 0; i < count; ++i) {
    for (double& x : xi) x = 2.0 * random.uniform() - 1.0;
    drawn_.push_back(vehicle::realise(vehicle, table, xi));
  }
  low_ = high_ = drawn_.front();
  for (const P& p : drawn_) {
    for (const auto field : FIELDS) {
      low_.*field = std::min(low_.*field, p.*field);
      high_.*field = std::max(high_.*field, p.*field);
    }
  }
}

void ParameterCloud::scatter(std::vector<P>& parameters, RandomSource& random) const {
  const double n = static_cast<double>(parameters.size());
  for (const auto field : FIELDS) {
    double mean = 0, variance = 0;
    for (const P& p : parameters) mean += p.*field / n;
    for (const P& p : parameters) variance += (p.*field - mean) * (p.*field - mean) / n;
    const double scatter = std::sqrt((1.0 - SHRINK * SHRINK) * variance);
    for (P& p : parameters) {
      p.*field = std::clamp(mean + SHRINK * (p.*field - mean) + scatter * random.normal(), low_.*field, high_.*field);
    }
  }
}

}  // namespace snapwing::planning
