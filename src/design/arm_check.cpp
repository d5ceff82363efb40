#include "snapwing/design/arm_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "snapwing/common/error.h"
#include "snapwing/design/arm_topology.h"
#include "snapwing/statics/arm_problem.h"

namespace snapwing::design {

namespace {

double interpolate(const std::vector<double>& x, const std::vector<double>& y, double at) {
  if (!std::isfinite(at)) return std::numeric_limits<double>::quiet_NaN();
  const auto above = std::lower_bound(x.begin(), x.end(), at);
  const std::size_t k = std::clamp<std::ptrdiff_t>(above - x.begin(), 1, static_cast<std::ptrdiff_t>(x.size()) - 1);
  return y[k - 1] + (at - x[k - 1]) / (x[k] - x[k - 1]) * (y[k] - y[k - 1]);
}

/// Traces one field and reads the curve off.
void trace(const ArmDesignSettings& s, const mpm::DensityField& field, ArmCheckCase& c) {
  const common::Vehicle& v = s.vehicle;
  statics::ArmProblemSettings physics;
  physics.plane = s.plane;
  physics.threads = s.threads;
  const elasticity::Material material{v.material.youngs_modulus.value, v.material.poisson_ratio.value,
                                      v.material.mass_density.value};
  statics::ArmCurveSettings curve_settings;
  curve_settings.from = 0;
  curve_settings.to = v.limits.travel_max;
  curve_settings.step = s.check_step;
  statics::ArmCurve curve;
  try {
    const statics::ArmProblem arm(v.arm, material, field, physics);
    curve = statics::traceArm(arm, curve_settings);
  } catch (const common::Error& e) {  // pin or clamp without material: an outcome of the design, not bad input
    c.message = e.what();
    return;
  }
  c.traced = curve.status == statics::SolveStatus::CONVERGED;
  c.message = curve.message;
  c.table = std::move(curve.table);
  c.table.arm_count = v.arm.count;
  if (!c.traced || c.table.travel.size() < 4) return;
  c.features = common::curveFeatures(c.table);
  c.hysteresis_share = c.features.hysteresis / std::abs(c.features.peak_force);
  c.rotation_second = interpolate(c.table.travel, c.table.rotation, c.features.second_travel);
  c.rotation_end = c.table.rotation.back();
  for (const int stable : c.table.stable) c.unstable_points += stable ? 0 : 1;
  c.bistable = c.features.bistable;
}

/// The wish must hold in every case.
ArmTarget judge(const ArmCheck& check, const std::string& name, double low, double high, const char* unit,
                double (*value)(const ArmCheckCase&), bool offset_cases) {
  ArmTarget t;
  t.name = name;
  char text[80];
  std::snprintf(text, sizeof text, "%g .. %g %s", low, high, unit);
  t.wanted = text;
  t.low = std::numeric_limits<double>::infinity(), t.high = -t.low;
  t.met = true;
  for (const ArmCheckCase& c : check.cases) {
    if (c.name == "grey" || (c.offset != 0 && !offset_cases)) continue;
    const double x = c.traced ? value(c) : std::numeric_limits<double>::quiet_NaN();
    t.met = t.met && x >= low && x <= high;
    if (std::isnan(x)) continue;
    t.low = std::min(t.low, x), t.high = std::max(t.high, x);
  }
  if (t.low > t.high) t.low = t.high = std::numeric_limits<double>::quiet_NaN();
  return t;
}

void judgeAll(ArmCheck& check) {
  using C = const ArmCheckCase&;
  check.targets = {
      judge(
          check, "peak force", 3.6, 4.0, "N", [](C c) { return c.features.peak_force; }, false),
      judge(
          check, "valley force", -1.3, 0.0, "N", [](C c) { return c.features.valley_force; }, false),
      judge(
          check, "second equilibrium", 0.050, 0.062, "m", [](C c) { return c.features.second_travel; }, false),
      judge(
          check, "arm rotation there", 0.75, 0.9, "rad", [](C c) { return c.rotation_second; }, false),
      judge(
          check, "hysteresis over peak", 0, 0.01, "", [](C c) { return c.hysteresis_share; }, false),
      judge(
          check, "unstable points", 0, 0, "", [](C c) { return static_cast<double>(c.unstable_points); }, false),
      judge(
          check, "bistable, printing error too", 1, 1, "", [](C c) { return c.bistable ? 1.0 : 0.0; }, true)};
  check.all_met = std::all_of(check.targets.begin(), check.targets.end(), [](const ArmTarget& t) { return t.met; });
  check.bistable = check.targets.back().met;
}

}  // namespace

ArmCheck checkArm(const ArmDesignSettings& s, const ArmShape& shape, const mpm::DensityField& grey,
                  const std::function<bool(const std::string&)>& progress) {
  ArmCheck check;
  const common::ArmSettings& arm = s.vehicle.arm;
  const auto add = [&](const std::string& name, double cell, double offset, const mpm::DensityField& field) {
    if (progress && progress(name)) return false;
    ArmCheckCase c;
    c.name = name, c.cell_size = cell, c.offset = offset;
    trace(s, field, c);
    check.cases.push_back(std::move(c));
    return true;
  };
  if (!grey.value.empty() && !add("grey", grey.cell_size, 0, grey)) return check;
  const double power = statics::ArmProblemSettings().interpolation.power;
  const double finest = *std::min_element(s.check_cells.begin(), s.check_cells.end());
  for (const double cell : s.check_cells) {
    for (const double offset : {0.0, -s.check_offset, s.check_offset}) {
      // The printing error is small against coarse cells: it is looked at on the finest grid only.
      if (offset != 0 && cell > finest) continue;
      char name[64];
      std::snprintf(name, sizeof name, offset == 0 ? "%.2f mm" : "%.2f mm, %+.2f mm", 1e3 * cell, 1e3 * offset);
      const mpm::DensityField domain = armDomain(arm, cell, 0);
      if (!add(name, cell, offset, shape.cover(domain, offset, power, arm.pin_x, arm.pin_y))) return check;
    }
  }
  judgeAll(check);
  return check;
}

}  // namespace snapwing::design
