#include "snapwing/design/arm/arm_check.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <limits>
#include <mutex>
#include <utility>

#include "arm_extrapolation.h"
#include "arm_judgement.h"
#include "design_scene.h"
#include "snapwing/common/error.h"
#include "snapwing/common/parallel.h"
#include "snapwing/statics/scene_curve.h"

namespace snapwing::design {

namespace {

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
  bool volumetric = false, quadratic = false;
};

using Cancel = std::function<bool(double, double)>;

/// The table of a vehicle's arm in the plane, which may fly, has all travels and pictures of the moved outline.
void traceBody(const ArmDesignSettings& s, const mpm::DensityField& field, const Body& body, const Cancel& cancel,
               ArmCheckCase& c) {
  const bool flies = !s.user_scene && !body.volumetric && !body.quadratic;
  SceneRung rung{body.volumetric, body.quadratic, field.cell_size,
                 body.volumetric ? s.check_volumetric_step : s.check_step};
  if (flies) rung.from = s.vehicle.limits.travel_min;
  const scene::Scene scene = designScene(s, rung, &field);
  const auto compiled = scene::compileScene(scene, 1);
  const statics::SceneCurve curve = statics::traceScene(scene, *compiled, {}, cancel);
  const statics::PathResult whole = curve.costs();
  c.traced = whole.status == solver::SolveStatus::CONVERGED;
  c.message = whole.message;
  if (curve.path.points.size() < 4) return;
  c.table = curve.table();
  if (flies) c.table.shapes = statics::outlineAlong(scene, *compiled, curve, s.body);
}

/// Traces one field and reads the curve off.
void trace(const ArmDesignSettings& s, const mpm::DensityField& field, const Body& body, const Cancel& cancel,
           ArmCheckCase& c) {
  c.turns = s.turns();
  try {
    traceBody(s, field, body, cancel, c);
  } catch (const common::Error& e) {  // pin or clamp without material: an outcome of the design, not bad input
    c.message = e.what();
    return;
  }
  c.table.arm_count = s.copies;
  if (!c.traced || c.table.travel.size() < 4) return;
  c.features = vehicle::curveFeatures(c.table);
  c.hysteresis_share = c.features.hysteresis / std::abs(c.features.peak_force);
  if (c.turns) c.rotation_second = interpolate(c.table.travel, c.table.rotation, c.features.second_travel);
  if (c.turns) c.rotation_end = c.table.rotation.back();
  for (const int stable : c.table.stable) c.unstable_points += stable ? 0 : 1;
  c.bistable = c.features.bistable;
}

/// The optimiser's own field, then the thresholded design on the grids, kernels and outlines of the settings.
std::vector<std::pair<Body, mpm::DensityField>> bodiesOf(const ArmDesignSettings& s, const ArmShape& shape,
                                                         const mpm::DensityField& grey) {
  std::vector<std::pair<Body, mpm::DensityField>> bodies;
  const double power = elasticity::DensityInterpolation().power;
  const std::array<double, 2> seed = designSeed(s);
  const auto add = [&](Body body, double cell, const char* suffix) {
    char name[64];
    std::snprintf(name, sizeof name, body.offset == 0 ? "%.2f mm%s" : "%.2f mm%s, %+.2f mm", 1e3 * cell, suffix,
                  1e3 * body.offset);
    body.name = name;
    bodies.emplace_back(body, shape.cover(designDomain(s, cell, 0), body.offset, power, seed[0], seed[1]));
  };
  if (!grey.value.empty()) {  // as the last stage saw it
    const bool solid = s.stages.back().volumetric;
    bodies.emplace_back(Body{"grey", solid ? VOLUMETRIC : PLANAR_LINEAR, 0, solid}, grey);
  }
  const double finest = *std::min_element(s.check_cells.begin(), s.check_cells.end());
  for (const double cell : s.check_cells) {
    for (const double offset : {0.0, -s.check_offset, s.check_offset}) {
      // The printing error is small against coarse cells: it is looked at on the finest grid only.
      if (offset != 0 && cell > finest) continue;
      add({"", PLANAR_LINEAR, offset}, cell, "");
      if (s.check_offset == 0) break;
    }
  }
  for (const double cell : s.check_quadratic_cells) add({"", PLANAR_QUADRATIC, 0, false, true}, cell, " B-spline");
  for (const double cell : s.check_volumetric_cells) add({"", VOLUMETRIC, 0, true}, cell, " solid");
  return bodies;
}

}  // namespace

namespace {

/// The body, and an empty cell on each side of the domain that it does not reach.
mpm::DensityField onWholeGrid(mpm::DensityField body, const mpm::DensityField& domain) {
  const int nx = body.cells[0], ny = body.cells[1];
  const auto side = [&](int i0, int i1, int j0, int j1) {
    for (const bool marking : {false, true}) {
      for (int j = j0; j <= j1; ++j) {
        for (int i = i0; i <= i1; ++i) {
          if (!marking && body.present(i, j)) return;
          if (!marking || !domain.present(i, j)) continue;
          body.value[static_cast<std::size_t>(j) * nx + i] = 0;
          return;
        }
      }
    }
  };
  side(0, 0, 0, ny - 1), side(nx - 1, nx - 1, 0, ny - 1);
  side(0, nx - 1, 0, 0), side(0, nx - 1, ny - 1, ny - 1);
  return body;
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
  const std::vector<std::pair<Body, mpm::DensityField>> bodies = bodiesOf(s, shape, grey);
  const int count = static_cast<int>(bodies.size());
  std::vector<ArmCheckCase> cases(bodies.size());
  std::vector<char> done(bodies.size(), 0);
  std::atomic<bool> cancelled{false};
  std::mutex telling;
  // The largest come last in the list and are begun first, so that none of them is left for one thread in the end.
  common::parallelFor(count, s.threads, [&](int n) {
    const auto& [body, field] = bodies[count - 1 - n];
    bool told = false;
    const auto cancel = [&, &body = body](double, double) {
      const std::lock_guard<std::mutex> one_at_a_time(telling);
      if (progress && progress(told ? "" : body.name)) cancelled = true;
      told = true;
      return cancelled.load();
    };
    if (cancel(0, 0)) return;
    ArmCheckCase& c = cases[count - 1 - n];
    c.name = body.name, c.rung = body.rung, c.cell_size = field.cell_size, c.offset = body.offset;
    c.solid = body.volumetric;
    trace(s, field, body, cancel, c);
    done[count - 1 - n] = !cancelled;
  });
  ArmCheck check;
  for (int n = 0; n < count; ++n) {
    if (done[n]) check.cases.push_back(std::move(cases[n]));
  }
  check.complete = !cancelled;
  if (const ArmCheckCase* finest = check.reference()) {
    const auto same = [&](const auto& pair) {
      return pair.first.offset == 0 && pair.first.rung == PLANAR_LINEAR && pair.first.name == finest->name;
    };
    const auto found = std::find_if(bodies.begin(), bodies.end(), same);
    check.body = onWholeGrid(found->second, designDomain(s, finest->cell_size, 0));
  }
  check.table = extrapolatedTable(check);
  judgeAll(s.targets, check);
  return check;
}

}  // namespace snapwing::design
