#include "snapwing/validation/arm_curve.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "snapwing/common/error.h"
#include "snapwing/mpm/coarsening.h"
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
  const mpm::DensityField field = mpm::loadDensityCsv(body, arm.domain_length, arm.domain_height)
                                      .resampled(cell_size, mpm::coarseningPower(mpm::Coarsening::STIFFNESS));
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
  curve.cell_size = cell_size;
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

Estimate estimateOf(const std::vector<ArmCurve>& curves, double ArmCurve::*member) {
  if (curves.empty()) return {};
  const ArmCurve &coarse = curves.front(), &fine = curves.back();
  if (curves.size() == 1) return {fine.*member, 0};
  return limitOfCells(fine.*member, coarse.*member, coarse.cell_size / fine.cell_size);
}

namespace {

std::string wholeWords(const ArmCurve& curve) {
  return curve.failure.empty() ? std::to_string(curve.travel.size()) + " points, all converged" : curve.failure;
}

bool snaps(const ArmCurve& curve) { return !curve.turns.empty() || curve.unstable > 0; }

std::string snapWords(const ArmCurve& curve) {
  if (!curve.turns.empty())
    return "the travel turns back at " + listed(curve.turns) + ": the arm snaps there by itself";
  if (curve.unstable == 0) return "stable at every travel";
  return std::to_string(curve.unstable) + " points are unstable at their travel: the arm snaps there by itself";
}

std::string stateWords(const ArmCurve& curve) {
  return curve.bistable ? "second equilibrium at " + shortly(1e3 * curve.second_travel) + " mm"
                        : "the force has no second stable zero";
}

/// PASS if it holds on each curve, FAIL if on none.
Check onEach(const std::string& name, const std::vector<ArmCurve>& curves, bool (*holds)(const ArmCurve&),
             std::string (*words)(const ArmCurve&)) {
  std::size_t good = 0;
  std::string text;
  for (const ArmCurve& curve : curves) {
    good += holds(curve) ? 1 : 0;
    if (curves.size() > 1) text += (text.empty() ? "" : "; ") + shortly(1e3 * curve.cell_size) + " mm: ";
    text += words(curve);
  }
  Check check = yesOrNo(name, good == curves.size(), text);
  if (good > 0 && good < curves.size()) {
    check.verdict = Verdict::UNDECIDED;
    check.words += "; smaller cells decide";
  }
  return check;
}

/// e.g. "3.775, 3.668 N"
std::string atEach(const std::vector<ArmCurve>& curves, double ArmCurve::*member, double factor,
                   const std::string& unit) {
  if (curves.size() == 1) return {};
  std::string text;
  for (const ArmCurve& curve : curves) text += (text.empty() ? "" : ", ") + shortly(factor * curve.*member);
  return "; " + text + " " + unit + " with cells of " + shortly(1e3 * curves.front().cell_size) + ", " +
         shortly(1e3 * curves.back().cell_size) + " mm";
}

}  // namespace

std::vector<Check> checkCurve(const std::vector<ArmCurve>& curves, const vehicle::ForceTable& table,
                              const vehicle::Vehicle& vehicle) {
  const vehicle::CurveFeatures stated = vehicle::curveFeatures(table);
  const std::string name = "static curve: ";
  std::vector<Check> checks;
  checks.push_back(onEach(
      name + "whole path", curves, [](const ArmCurve& c) { return c.failure.empty(); }, wholeWords));
  checks.push_back(onEach(
      name + "no internal snap", curves, [](const ArmCurve& c) { return !snaps(c); }, snapWords));
  for (const ArmCurve& curve : curves) {
    if (!curve.failure.empty() || !curve.turns.empty()) return checks;
  }
  checks.push_back(onEach(
      name + "two stable states", curves, [](const ArmCurve& c) { return c.bistable; }, stateWords));
  const common::Quantity& scale = vehicle.arm.force_scale;
  checks.push_back(
      within(name + "peak", estimateOf(curves, &ArmCurve::peak_force), scale.low() * stated.peak_force,
             scale.high() * stated.peak_force, "N",
             "allowed: the table's, within arm.force_scale" + atEach(curves, &ArmCurve::peak_force, 1, "N")));
  if (checks[2].verdict == Verdict::PASS) {
    const Estimate second = estimateOf(curves, &ArmCurve::second_travel).times(1e3);
    checks.push_back(within(name + "second equilibrium", second, 1e3 * (stated.second_travel - SECOND_TOLERANCE),
                            1e3 * (stated.second_travel + SECOND_TOLERANCE), "mm",
                            "allowed: the table's, within 2 mm" + atEach(curves, &ArmCurve::second_travel, 1e3, "mm")));
  }
  const Estimate valley = estimateOf(curves, &ArmCurve::valley_force);
  checks.push_back(reported(
      name + "valley", valley.value, "N",
      "the table has " + shortly(stated.valley_force) + " N" + atEach(curves, &ArmCurve::valley_force, 1, "N")));
  checks.back().error = valley.error;
  checks.push_back(reported(name + "smallest det F", curves.back().min_det_f, "1"));
  return checks;
}

}  // namespace snapwing::validation
