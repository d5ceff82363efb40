#include "snapwing/motion/static_curve.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"
#include "snapwing/solver/equilibrium.h"

namespace snapwing::motion {

namespace {

/// Coarse curve, from which steps in time go on: rounding of a solid's light cells may reach 1e-9 of its forces.
solver::NewtonSettings tolerances(const std::function<bool()>& cancelled) {
  solver::NewtonSettings settings;
  settings.relative_tolerance = 1e-8;
  settings.cancelled = cancelled;
  return settings;
}

StaticPoint describe(const solver::Equilibrium& x) {
  return {x.p(0), x.force(), x.stiffness, x.at.min_det_f, x.negative_pivots == 0, x.z, x.slope};
}

[[noreturn]] void notFound(double control, const solver::NewtonResult& result) {
  throw common::Error("the static curve has no equilibrium at " + common::toText(1e3 * control) +
                      " mm: " + solver::statusName(result.status) + ", " + result.message);
}

/// Without inertia; the energy is the integral of the cubic through force and stiffness.
vehicle::ForceTable tableOf(const std::vector<StaticPoint>& points) {
  vehicle::ForceTable table;
  double energy = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const StaticPoint& now = points[k];
    if (k > 0) {
      const StaticPoint& before = points[k - 1];
      const double h = now.control - before.control;
      energy += h / 2 * (before.force + now.force) + h * h / 12 * (before.stiffness - now.stiffness);
    }
    table.travel.push_back(now.control);
    table.force.push_back(now.force);
    table.stiffness.push_back(now.stiffness);
    table.energy.push_back(energy);
    table.min_det_f.push_back(now.min_det_f);
    table.stable.push_back(now.stable ? 1 : 0);
  }
  table.rotation.assign(points.size(), 0.0);
  table.kinetic_mass = table.coupled_mass = table.rotation;
  table.iterations.assign(points.size(), 0);
  return table;
}

}  // namespace

StaticCurve::StaticCurve(const scene::CompiledScene& scene, double to, double step, std::function<bool()> cancelled)
    : scene_(scene), cancelled_(std::move(cancelled)) {
  if (!(to > 0) || !(step > 0)) throw common::Error("a static curve goes to a control > 0 in steps > 0");
  follow(to, step);
  table_ = tableOf(points_);
  features_ = vehicle::curveFeatures(table_);
}

void StaticCurve::follow(double to, double step) {
  solver::EquilibriumSolver solver(scene_->problem(), tolerances(cancelled_));
  solver::Equilibrium x = solver.start(Eigen::VectorXd::Zero(scene_->problem().freeCount()), 0);
  solver::NewtonResult result = solver.minimise(x);
  if (!result.converged()) notFound(0, result);
  solver.linearise(x);
  points_.push_back(describe(x));
  const int count = std::max(1, static_cast<int>(std::ceil(to / step - 1e-9)));
  double smaller = 1;
  for (double next = to / count; points_.back().control < to * (1 - 1e-12);) {
    solver::Equilibrium trial = solver.predict(x, std::min(next, to));
    result = solver.minimise(trial);
    if (!result.converged()) {
      smaller *= 0.5;
      if (smaller < 1e-3 || result.status == solver::SolveStatus::CANCELLED) notFound(next, result);
      next = points_.back().control + smaller * to / count;
      continue;
    }
    solver.linearise(trial);
    x = trial;
    points_.push_back(describe(x));
    smaller = std::min(1.0, 2 * smaller);
    next = points_.back().control + smaller * to / count;
  }
}

StaticPoint StaticCurve::at(double control) const {
  const auto nearest =
      std::min_element(points_.begin(), points_.end(), [&](const StaticPoint& a, const StaticPoint& b) {
        return std::abs(a.control - control) < std::abs(b.control - control);
      });
  solver::EquilibriumSolver solver(scene_->problem(), tolerances(cancelled_));
  solver::Equilibrium x = solver.start(nearest->z + (control - nearest->control) * nearest->slope, control);
  const solver::NewtonResult result = solver.minimise(x);
  if (!result.converged()) notFound(control, result);
  solver.linearise(x);
  return describe(x);
}

}  // namespace snapwing::motion
