#include "snapwing/design/arm_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "snapwing/common/error.h"
#include "snapwing/design/arm_scene.h"
#include "snapwing/design/arm_topology.h"
#include "snapwing/statics/arm_problem.h"
#include "snapwing/statics/scene_curve.h"

namespace snapwing::design {

namespace {

constexpr char PLANAR_LINEAR[] = "planar, linear kernel";
constexpr char PLANAR_QUADRATIC[] = "planar, quadratic B-spline";
constexpr char VOLUMETRIC[] = "volumetric, linear kernel, reduced volume term";

double interpolate(const std::vector<double>& x, const std::vector<double>& y, double at) {
  if (!std::isfinite(at)) return std::numeric_limits<double>::quiet_NaN();
  const auto above = std::lower_bound(x.begin(), x.end(), at);
  const std::size_t k = std::clamp<std::ptrdiff_t>(above - x.begin(), 1, static_cast<std::ptrdiff_t>(x.size()) - 1);
  return y[k - 1] + (at - x[k - 1]) / (x[k] - x[k - 1]) * (y[k] - y[k - 1]);
}

/// One body to trace.
struct Body {
  std::string name, rung;
  double offset = 0;
  bool grey = false;
  int dimension = 2;
  statics::SceneKernel kernel = statics::SceneKernel::LINEAR;
};

using Cancel = std::function<bool(double, double)>;

/// With pictures of the moved outline.
void tracePlanar(const ArmDesignSettings& s, const mpm::DensityField& field, const Cancel& cancel, ArmCheckCase& c) {
  const common::Vehicle& v = s.vehicle;
  statics::ArmProblemSettings physics;
  physics.plane = s.plane;
  physics.threads = s.threads;
  const elasticity::Material material{v.material.youngs_modulus.value, v.material.poisson_ratio.value,
                                      v.material.mass_density.value};
  statics::ArmCurveSettings settings;
  settings.from = 0;
  settings.to = v.limits.travel_max;
  settings.step = s.check_step;
  settings.progress = cancel;
  const statics::ArmProblem arm(v.arm, material, field, physics);
  statics::ArmCurve curve = statics::traceArm(arm, settings);
  c.traced = curve.status == statics::SolveStatus::CONVERGED;
  c.message = curve.message;
  c.table = std::move(curve.table);
}

void traceAsScene(const ArmDesignSettings& s, const mpm::DensityField& field, const Body& body, const Cancel& cancel,
                  ArmCheckCase& c) {
  ArmSceneSettings settings;
  settings.dimension = body.dimension;
  settings.plane = s.plane;
  settings.kernel = body.kernel;
  settings.step = body.dimension == 3 ? s.check_volumetric_step : s.check_step;
  const statics::Scene scene = armScene(s.vehicle, field, settings);
  const auto compiled = statics::compileScene(scene, s.threads);
  const statics::SceneCurve curve = statics::traceScene(scene, *compiled, {}, cancel);
  const bool forward = curve.path.status == statics::SolveStatus::CONVERGED;
  c.traced = forward && curve.back.status == statics::SolveStatus::CONVERGED;
  c.message = forward ? curve.back.message : curve.path.message;
  if (curve.path.points.size() < 4) return;
  c.table = curve.table();
  for (std::size_t k = 0; k < curve.monitors.size(); ++k) c.table.rotation[k] = curve.monitors[k][0];
}

/// Traces one field and reads the curve off.
void trace(const ArmDesignSettings& s, const mpm::DensityField& field, const Body& body, const Cancel& cancel,
           ArmCheckCase& c) {
  try {
    const bool scene = body.dimension == 3 || body.kernel != statics::SceneKernel::LINEAR;
    scene ? traceAsScene(s, field, body, cancel, c) : tracePlanar(s, field, cancel, c);
  } catch (const common::Error& e) {  // pin or clamp without material: an outcome of the design, not bad input
    c.message = e.what();
    return;
  }
  c.table.arm_count = s.vehicle.arm.count;
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
  check.bistable = check.complete && check.targets.back().met;
  check.all_met = check.all_met && check.complete;
}

}  // namespace

const ArmCheckCase* ArmCheck::reference() const {
  const ArmCheckCase* best = nullptr;
  for (const ArmCheckCase& c : cases) {
    const bool candidate = c.traced && c.name != "grey" && c.offset == 0 && c.rung == PLANAR_LINEAR;
    if (candidate && (!best || c.cell_size < best->cell_size)) best = &c;
  }
  return best;
}

ArmCheck checkArm(const ArmDesignSettings& s, const ArmShape& shape, const mpm::DensityField& grey,
                  const std::function<bool(const std::string&)>& progress) {
  ArmCheck check;
  const common::ArmSettings& arm = s.vehicle.arm;
  bool cancelled = false;
  const auto add = [&](const Body& body, const mpm::DensityField& field) {
    const auto cancel = [&](double, double) { return cancelled = cancelled || (progress && progress(body.name)); };
    if (cancel(0, 0)) return;
    ArmCheckCase c;
    c.name = body.name, c.rung = body.rung, c.cell_size = field.cell_size, c.offset = body.offset;
    trace(s, field, body, cancel, c);
    if (!cancelled) check.cases.push_back(std::move(c));
  };
  const double power = statics::ArmProblemSettings().interpolation.power;
  const auto addShape = [&](Body body, double cell, const char* suffix) {
    char name[64];
    std::snprintf(name, sizeof name, body.offset == 0 ? "%.2f mm%s" : "%.2f mm%s, %+.2f mm", 1e3 * cell, suffix,
                  1e3 * body.offset);
    body.name = name;
    add(body, shape.cover(armDomain(arm, cell, 0), body.offset, power, arm.pin_x, arm.pin_y));
  };
  if (!grey.value.empty()) add({"grey", PLANAR_LINEAR, 0, true}, grey);
  const double finest = *std::min_element(s.check_cells.begin(), s.check_cells.end());
  for (const double cell : s.check_cells) {
    for (const double offset : {0.0, -s.check_offset, s.check_offset}) {
      // The printing error is small against coarse cells: it is looked at on the finest grid only.
      if (offset != 0 && cell > finest) continue;
      addShape({"", PLANAR_LINEAR, offset}, cell, "");
    }
  }
  using statics::SceneKernel;
  if (s.check_quadratic_cell > 0) {
    addShape({"", PLANAR_QUADRATIC, 0, false, 2, SceneKernel::QUADRATIC}, s.check_quadratic_cell, " B-spline");
  }
  if (s.check_volumetric_cell > 0) {
    addShape({"", VOLUMETRIC, 0, false, 3, SceneKernel::LINEAR_REDUCED}, s.check_volumetric_cell, " solid");
  }
  check.complete = !cancelled;
  judgeAll(check);
  return check;
}

}  // namespace snapwing::design
