#include "snapwing/statics/features.h"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>

namespace snapwing::statics {

std::string featureName(FeatureKind kind) {
  if (kind == FeatureKind::ZERO) return "zero";
  return kind == FeatureKind::PEAK ? "peak" : "valley";
}

namespace {

bool restore(EquilibriumSolver& solver, const PathPoint& point, Equilibrium& x) {
  x = solver.start(point.solution, point.control);
  if (point.multipliers.size() > 0) x.multipliers = point.multipliers;
  return solver.correct(x).converged();
}

/// Searches the branch between two neighbouring points.
class Interval {
 public:
  Interval(EquilibriumSolver& solver, const Equilibrium& a, const Equilibrium& b)
      : solver_(solver), a_(a), b_(b), chord_(a, b) {}

  bool search(FeatureKind kind, Feature& found) {
    kind_ = kind;
    const double low = value(a_), high = value(b_);
    if (!(low * high < 0)) return false;
    lost_ = false;
    std::uintmax_t calls = 60;
    const auto narrow = [](double l, double h) { return h - l < 1e-12; };
    const auto bracket =
        boost::math::tools::toms748_solve([&](double s) { return at(s); }, 0.0, 1.0, low, high, narrow, calls);
    if (lost_) return false;
    const double s = 0.5 * (bracket.first + bracket.second);
    if (std::isnan(at(s)) || lost_) return false;
    found.kind = kind == FeatureKind::ZERO ? kind : (low > 0 ? FeatureKind::PEAK : FeatureKind::VALLEY);
    found.point = describePoint(x_, 0, 0, true);
    found.accuracy = std::abs((bracket.second - bracket.first) * chord_.controlRate(x_));
    found.remainder = std::abs(kind == FeatureKind::ZERO ? x_.force() : x_.stiffness);
    return true;
  }

 private:
  double value(const Equilibrium& x) const {
    if (kind_ == FeatureKind::ZERO) return x.force();
    // Along the branch, so that a control that turns makes no extreme; signs as for a growing control.
    return chord_.forceRate(x) * (b_.p(0) >= a_.p(0) ? 1 : -1);
  }
  double at(double s) {
    if (s <= 0 || s >= 1) {
      x_ = s <= 0 ? a_ : b_;
      return value(x_);
    }
    x_ = chord_.guess(s);
    if (!lost_ && !solver_.correctOn(chord_.plane(s), x_).converged()) lost_ = true;
    return lost_ ? 0.0 : value(x_);  // zero ends the search
  }

  EquilibriumSolver& solver_;
  const Equilibrium &a_, &b_;
  Chord chord_;
  FeatureKind kind_ = FeatureKind::ZERO;
  Equilibrium x_;
  bool lost_ = false;
};

}  // namespace

std::vector<Feature> locateFeatures(EquilibriumSolver& solver, const std::vector<PathPoint>& points) {
  std::vector<Feature> found;
  double largest = 0;
  for (const PathPoint& p : points) largest = std::max(largest, std::abs(p.force));
  const auto zero = [&](const PathPoint& p) { return std::abs(p.force) <= 1e-9 * largest; };
  for (std::size_t k = 0; k < points.size(); ++k) {
    // Points that are at rest themselves, as the undeformed one.
    if (zero(points[k]) && largest > 0) {
      found.push_back({FeatureKind::ZERO, static_cast<int>(k), points[k], 0, std::abs(points[k].force)});
    }
    if (k + 1 == points.size()) break;
    const PathPoint &a = points[k], &b = points[k + 1];
    const bool crosses = a.force * b.force < 0 && !zero(a) && !zero(b);
    const bool turns = a.stiffness * b.stiffness < 0;
    if (!crosses && !turns) continue;
    Equilibrium from, to;
    if (!restore(solver, a, from) || !restore(solver, b, to)) continue;
    Interval interval(solver, from, to);
    Feature feature;
    feature.after = static_cast<int>(k);
    if (crosses && interval.search(FeatureKind::ZERO, feature)) found.push_back(feature);
    if (turns && interval.search(FeatureKind::PEAK, feature)) found.push_back(feature);
  }
  return found;
}

}  // namespace snapwing::statics
