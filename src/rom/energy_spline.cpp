#include "snapwing/rom/energy_spline.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "snapwing/common/error.h"

namespace snapwing::rom {

namespace {

// Quintic a0 + a1 t + ... + a5 t^5 on t in [0, 1] with value, slope and curvature given at both ends (per unit of t).
std::array<double, 6> quintic(double e0, double f0, double k0, double e1, double f1, double k1) {
  const double rise = e1 - e0 - f0 - 0.5 * k0;
  const double turn = f1 - f0 - k0;
  const double bend = k1 - k0;
  return {e0,
          f0,
          0.5 * k0,
          10.0 * rise - 4.0 * turn + 0.5 * bend,
          -15.0 * rise + 7.0 * turn - bend,
          6.0 * rise - 3.0 * turn + 0.5 * bend};
}

// A stiffness that at least doubles within 5 mm beyond the table: no trajectory runs away.
double growthBeyond(double end_stiffness) { return std::max(end_stiffness, 1.0) / 0.005; }

}  // namespace

EnergySpline::EnergySpline(const vehicle::ForceTable& table, double force_scale) {
  table.validate();
  auto curve = std::make_shared<Curve>();
  curve->travel = table.travel;
  const double arms = table.arm_count;
  const std::size_t count = table.travel.size();
  curve->coefficients.resize(6 * (count - 1));
  curve->inverse_width.resize(count - 1);
  double narrowest = INFINITY, widest = 0;
  for (std::size_t i = 0; i + 1 < count; ++i) {
    const double h = table.travel[i + 1] - table.travel[i];
    narrowest = std::min(narrowest, h);
    widest = std::max(widest, h);
    curve->inverse_width[i] = 1.0 / h;
    const auto a =
        quintic(arms * table.energy[i], arms * h * table.force[i], arms * h * h * table.stiffness[i],
                arms * table.energy[i + 1], arms * h * table.force[i + 1], arms * h * h * table.stiffness[i + 1]);
    std::copy(a.begin(), a.end(), curve->coefficients.begin() + 6 * i);
  }
  if (widest - narrowest < 1e-9 * widest) {
    curve->uniform_inverse = (count - 1) / (table.travel.back() - table.travel.front());
  }
  curve->low = {arms * table.energy.front(), arms * table.force.front(), arms * table.stiffness.front()};
  curve->high = {arms * table.energy.back(), arms * table.force.back(), arms * table.stiffness.back()};
  curve->growth_low = growthBeyond(curve->low.stiffness);
  curve->growth_high = growthBeyond(curve->high.stiffness);
  curve->force_error = curve->knotRemovalError();
  curve_ = curve;
  // A little beyond the ends, so that a table which begins at rest (u = 0, F = 0) shows its first equilibrium.
  scaleTo(force_scale, findEquilibria(*this, lowest() - 2e-3, highest() + 2e-3));
}

void EnergySpline::scaleTo(double force_scale, const Equilibria& unscaled) {
  if (!(force_scale > 0 && std::isfinite(force_scale))) {
    throw common::Error("force scale is " + std::to_string(force_scale) + "; allowed: > 0");
  }
  scale_ = force_scale;
  unscaled_ = equilibria_ = unscaled;
  for (double* scaled :
       {&equilibria_.peak_force, &equilibria_.valley_force, &equilibria_.barrier_first, &equilibria_.barrier_second}) {
    *scaled *= force_scale;
  }
}

EnergySpline EnergySpline::withForceScale(double force_scale) const {
  EnergySpline other = *this;
  other.scaleTo(force_scale, unscaled_);
  return other;
}

PotentialSample EnergySpline::at(double u) const {
  PotentialSample sample = curve_->at(u);
  sample.energy *= scale_;
  sample.force *= scale_;
  sample.stiffness *= scale_;
  return sample;
}

PotentialSample EnergySpline::Curve::at(double u) const {
  // Outside: stiffness goes on linearly, force and energy are its integrals. dF/du > 0 for outward moves at last.
  if (u > travel.back()) {
    const double d = u - travel.back();
    return {high.energy + d * (high.force + d * (0.5 * high.stiffness + d * growth_high / 6.0)),
            high.force + d * (high.stiffness + 0.5 * d * growth_high), high.stiffness + d * growth_high};
  }
  if (u < travel.front()) {
    const double d = u - travel.front();
    return {low.energy + d * (low.force + d * (0.5 * low.stiffness - d * growth_low / 6.0)),
            low.force + d * (low.stiffness - 0.5 * d * growth_low), low.stiffness - d * growth_low};
  }
  std::size_t i;
  if (uniform_inverse > 0) {
    i = std::min<std::size_t>((u - travel.front()) * uniform_inverse, inverse_width.size() - 1);
  } else {
    const auto above = std::upper_bound(travel.begin(), travel.end(), u);
    i = std::min<std::size_t>(above - travel.begin() - 1, inverse_width.size() - 1);
  }
  const double s = inverse_width[i];
  const double t = (u - travel[i]) * s;
  const double* a = &coefficients[6 * i];
  PotentialSample out;
  out.energy = a[0] + t * (a[1] + t * (a[2] + t * (a[3] + t * (a[4] + t * a[5]))));
  out.force = s * (a[1] + t * (2 * a[2] + t * (3 * a[3] + t * (4 * a[4] + t * 5 * a[5]))));
  out.stiffness = s * s * (2 * a[2] + t * (6 * a[3] + t * (12 * a[4] + t * 20 * a[5])));
  return out;
}

double EnergySpline::Curve::knotRemovalError() const {
  // The removed knot's error is that of a spline with doubled spacing: an upper estimate for the spacing in use.
  double worst = 0;
  for (std::size_t i = 0; i + 2 < travel.size(); ++i) {
    const PotentialSample a = at(travel[i]), m = at(travel[i + 1]), b = at(travel[i + 2]);
    const double h = travel[i + 2] - travel[i];
    const auto q = quintic(a.energy, h * a.force, h * h * a.stiffness, b.energy, h * b.force, h * h * b.stiffness);
    const double t = (travel[i + 1] - travel[i]) / h;
    const double force = (q[1] + t * (2 * q[2] + t * (3 * q[3] + t * (4 * q[4] + t * 5 * q[5])))) / h;
    worst = std::max(worst, std::abs(force - m.force));
  }
  return worst;
}

}  // namespace snapwing::rom
