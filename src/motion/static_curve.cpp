#include "snapwing/motion/static_curve.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"
#include "snapwing/solver/equilibrium.h"

namespace snapwing::motion {

namespace {

constexpr double NONE = std::numeric_limits<double>::quiet_NaN();

/// Coarse curve, from which steps in time go on: rounding of a solid's light cells may reach 1e-9 of its forces.
solver::NewtonSettings tolerances() {
  solver::NewtonSettings settings;
  settings.relative_tolerance = 1e-8;
  return settings;
}

StaticPoint describe(const solver::Equilibrium& x) { return {x.p(0), x.force(), x.stiffness, x.z, x.slope}; }

[[noreturn]] void notFound(double control, const solver::NewtonResult& result) {
  throw common::Error("the static curve has no equilibrium at " + common::toText(1e3 * control) +
                      " mm: " + solver::statusName(result.status) + ", " + result.message);
}

}  // namespace

StaticCurve::StaticCurve(const scene::CompiledScene& scene, double to, double step)
    : scene_(scene), barrier_(NONE), valley_(NONE), second_(NONE) {
  if (!(to > 0) || !(step > 0)) throw common::Error("a static curve goes to a control > 0 in steps > 0");
  solver::EquilibriumSolver solver(scene.problem(), tolerances());
  solver::Equilibrium x = solver.start(Eigen::VectorXd::Zero(scene.problem().freeCount()), 0);
  solver::NewtonResult result = solver.minimise(x);
  if (!result.converged()) notFound(0, result);
  solver.settle(x);
  points_.push_back(describe(x));
  const int count = std::max(1, static_cast<int>(std::ceil(to / step - 1e-9)));
  double smaller = 1;
  for (double next = to / count; points_.back().control < to * (1 - 1e-12);) {
    solver::Equilibrium trial = solver.predict(x, std::min(next, to));
    result = solver.minimise(trial);
    if (!result.converged()) {
      smaller *= 0.5;
      if (smaller < 1e-3) notFound(next, result);
      next = points_.back().control + smaller * to / count;
      continue;
    }
    solver.settle(trial);
    x = trial;
    points_.push_back(describe(x));
    smaller = std::min(1.0, 2 * smaller);
    next = points_.back().control + smaller * to / count;
  }
  findFeatures();
}

double StaticCurve::forceAt(double control) const {
  const auto after = std::upper_bound(points_.begin(), points_.end(), control,
                                      [](double value, const StaticPoint& p) { return value < p.control; });
  const std::size_t k = std::clamp<std::size_t>(after - points_.begin(), 1, points_.size() - 1) - 1;
  const StaticPoint &a = points_[k], &b = points_[k + 1];
  const double h = b.control - a.control, t = (control - a.control) / h;
  if (t < 0) return a.force + a.stiffness * (control - a.control);
  if (t > 1) return b.force + b.stiffness * (control - b.control);
  const double s = 1 - t;
  return s * s * (1 + 2 * t) * a.force + t * t * (3 - 2 * t) * b.force +
         h * t * s * (s * a.stiffness - t * b.stiffness);
}

/// Zero of the force between the points k and k + 1.
double StaticCurve::zero(std::size_t k) const {
  double low = points_[k].control, high = points_[k + 1].control;
  const bool falls = points_[k].force > 0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    ((forceAt(middle) > 0) == falls ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

void StaticCurve::findFeatures() {
  std::size_t least = 0;
  for (std::size_t k = 1; k + 1 < points_.size(); ++k) {
    if (std::isnan(barrier_) && points_[k].force > 0 && points_[k + 1].force <= 0) barrier_ = zero(k);
    if (!std::isnan(barrier_) && points_[k].force < points_[least].force) least = k;
    if (!std::isnan(barrier_) && points_[k].force < 0 && points_[k + 1].force >= 0) {
      second_ = zero(k);
      break;
    }
  }
  if (std::isnan(second_)) return;
  double low = points_[least - 1].control, high = points_[least + 1].control;
  for (int i = 0; i < 80; ++i) {  // golden section would do; thirds are plain
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    (forceAt(a) < forceAt(b) ? high : low) = forceAt(a) < forceAt(b) ? b : a;
  }
  valley_ = 0.5 * (low + high);
}

StaticPoint StaticCurve::at(double control) const {
  const auto nearest =
      std::min_element(points_.begin(), points_.end(), [&](const StaticPoint& a, const StaticPoint& b) {
        return std::abs(a.control - control) < std::abs(b.control - control);
      });
  solver::EquilibriumSolver solver(scene_.problem(), tolerances());
  solver::Equilibrium x = solver.start(nearest->z + (control - nearest->control) * nearest->slope, control);
  const solver::NewtonResult result = solver.minimise(x);
  if (!result.converged()) notFound(control, result);
  solver.settle(x);
  return describe(x);
}

}  // namespace snapwing::motion
