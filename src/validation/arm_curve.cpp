#include "snapwing/validation/arm_curve.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "snapwing/common/error.h"
#include "snapwing/mpm/density_file.h"
#include "snapwing/scene/arm_scene.h"
#include "snapwing/statics/scene_curve.h"

namespace snapwing::validation {

namespace {

constexpr double SECOND_TOLERANCE = 0.002;  // [m] between the second equilibria of body and table

std::string shortly(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

std::string listed(const std::vector<double>& travels) {
  std::string text;
  for (const double u : travels) text += (text.empty() ? "" : ", ") + shortly(1e3 * u) + " mm";
  return text;
}

}  // namespace

ArmCurve traceArm(const vehicle::Vehicle& vehicle, const std::string& body, double cell_size,
                  const std::function<bool()>& cancelled) {
  const vehicle::ArmSettings& arm = vehicle.arm;
  const mpm::DensityField field = mpm::loadDensityCsv(body, arm.domain_length, arm.domain_height).resampled(cell_size);
  scene::ArmSceneSettings settings;
  settings.back = false;
  scene::Scene scene = scene::armScene(vehicle, field, settings);
  scene.copies = arm.count;
  const auto compiled = scene::compileScene(scene, 1);
  statics::TraceSettings how;
  how.method = statics::TraceMethod::AUTOMATIC;
  how.largest_arc = 400;
  how.newton.cancelled = cancelled;
  const statics::SceneCurve traced =
      statics::traceScene(scene, *compiled, how, [&](double, double) { return cancelled && cancelled(); });
  ArmCurve curve;
  if (traced.path.status != solver::SolveStatus::CONVERGED) {
    curve.failure = solver::statusName(traced.path.status) + ": " + traced.path.message;
  }
  for (const statics::PathPoint& p : traced.path.points) {
    curve.travel.push_back(p.control);
    curve.force.push_back(traced.multiplicity * p.force);
    curve.unstable += p.stable ? 0 : 1;
    curve.min_det_f = std::min(curve.min_det_f, p.min_det_f);
  }
  for (const int k : traced.limit_points)
    curve.turns.push_back(traced.path.points[static_cast<std::size_t>(k)].control);
  if (curve.failure.empty() && curve.turns.empty()) {
    const vehicle::CurveFeatures f = vehicle::curveFeatures(traced.table());
    curve.bistable = f.bistable;
    curve.peak_force = f.peak_force, curve.valley_force = f.valley_force;
    curve.barrier_travel = f.barrier_travel, curve.second_travel = f.second_travel;
  }
  return curve;
}

std::vector<Check> checkCurve(const ArmCurve& curve, const vehicle::ForceTable& table,
                              const vehicle::Vehicle& vehicle) {
  const vehicle::CurveFeatures stated = vehicle::curveFeatures(table);
  const std::string name = "static curve: ";
  std::vector<Check> checks;
  checks.push_back(
      yesOrNo(name + "whole path", curve.failure.empty(),
              curve.failure.empty() ? std::to_string(curve.travel.size()) + " points, all converged" : curve.failure));
  const bool snaps = !curve.turns.empty() || curve.unstable > 0;
  checks.push_back(yesOrNo(
      name + "no internal snap", !snaps,
      !curve.turns.empty() ? "the travel turns back at " + listed(curve.turns) + ": the arm jumps there by itself"
      : snaps ? std::to_string(curve.unstable) + " points are unstable at their travel: the arm jumps there by itself"
              : "stable at every travel"));
  if (!curve.failure.empty() || !curve.turns.empty()) return checks;
  checks.push_back(yesOrNo(name + "two stable states", curve.bistable,
                           curve.bistable ? "second equilibrium at " + shortly(1e3 * curve.second_travel) + " mm"
                                          : "the force has no second stable zero"));
  const common::Quantity& scale = vehicle.arm.force_scale;
  checks.push_back(within(name + "peak", curve.peak_force, scale.low() * stated.peak_force,
                          scale.high() * stated.peak_force, "N", "allowed: the table's, within arm.force_scale"));
  if (curve.bistable) {
    checks.push_back(
        within(name + "second equilibrium", 1e3 * curve.second_travel, 1e3 * (stated.second_travel - SECOND_TOLERANCE),
               1e3 * (stated.second_travel + SECOND_TOLERANCE), "mm", "allowed: the table's, within 2 mm"));
  }
  checks.push_back(
      told(name + "valley", curve.valley_force, "N", "the table has " + shortly(stated.valley_force) + " N"));
  checks.push_back(told(name + "smallest det F", curve.min_det_f, "1"));
  return checks;
}

}  // namespace snapwing::validation
