#include "snapwing/statics/features.h"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>

#include "snapwing/common/bisection.h"

namespace snapwing::statics {

std::string featureName(FeatureKind kind) {
  if (kind == FeatureKind::ZERO) return "zero";
  return kind == FeatureKind::PEAK ? "peak" : "valley";
}

namespace {

bool restore(solver::EquilibriumSolver& solver, const PathPoint& point, solver::Equilibrium& x) {
  x = solver.start(point.solution, point.control);
  if (point.multipliers.size() > 0) x.multipliers = point.multipliers;
  return solver.correct(x).converged();
}

/// Searches the branch between two neighbouring points.
class Interval {
 public:
  Interval(solver::EquilibriumSolver& solver, const solver::Equilibrium& a, const solver::Equilibrium& b)
      : solver_(solver), a_(a), b_(b), chord_(a, b) {}

  /// @param zero  of the force, else of its slope
  bool search(bool zero, Feature& found) {
    zero_ = zero;
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
    found.point = describePoint(x_, 0, 0, true);
    found.accuracy = std::abs((bracket.second - bracket.first) * chord_.controlRate(x_));
    found.remainder = std::abs(zero ? x_.force() : x_.stiffness);
    return true;
  }

 private:
  double value(const solver::Equilibrium& x) const {
    if (zero_) return x.force();
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

  solver::EquilibriumSolver& solver_;
  const solver::Equilibrium &a_, &b_;
  Chord chord_;
  bool zero_ = true;
  solver::Equilibrium x_;
  bool lost_ = false;
};

/// The stable branch between neighbouring points k and k + 1 as a function of the control.
class StableInterval {
 public:
  StableInterval(solver::EquilibriumSolver& solver, const std::vector<PathPoint>& points, std::size_t k)
      : solver_(solver), points_(points), k_(k), a_(points[k]), b_(points[k + 1]), h_(b_.control - a_.control) {}

  /// @return false: ask elsewhere
  bool search(bool zero, Feature& found) {
    const auto plain = [](const PathPoint& p) { return p.negative_pivots == 0 && !p.by_arc; };
    if (solver_.constraintCount() > 0 || !plain(a_) || !plain(b_) || h_ == 0) return false;
    double p = a_.control + root(zero) * h_, before = NAN, value_before = 0;
    solver::Equilibrium x = solver_.start(guess(p), p);
    for (int k = 0; k < LARGEST_COUNT; ++k) {
      if (!solver_.minimise(x).converged()) return false;
      solver_.lineariseNear(x, slopeGuess(p));
      if (x.negative_pivots != 0 || left(x)) return false;
      const double value = zero ? x.force() : x.stiffness;
      double slope = x.stiffness;
      if (!zero) slope = k == 0 ? curvature((p - a_.control) / h_) : (value - value_before) / (p - before);
      const double dp = -value / slope;
      if (std::abs(dp) <= TOLERANCE * std::abs(h_) || value == 0) {
        found.point = describePoint(x, 0, 0, true);
        found.accuracy = value == 0 ? 0 : std::abs(dp);
        found.remainder = std::abs(value);
        return true;
      }
      before = p, value_before = value;
      p += dp;
      if (!((p - a_.control) * h_ > 0 && (b_.control - p) * h_ > 0)) return false;
      x = solver_.predict(x, p);
    }
    return false;
  }

 private:
  static constexpr int LARGEST_COUNT = 8;
  static constexpr double TOLERANCE = 1e-9;  ///< share of the interval: the tangents' own rounding

  double force(double s) const {
    const double r = 1 - s;
    return r * r * (1 + 2 * s) * a_.force + s * r * r * h_ * a_.stiffness + s * s * (3 - 2 * s) * b_.force -
           s * s * r * h_ * b_.stiffness;
  }
  double stiffness(double s) const {
    return 6 * s * (1 - s) * (b_.force - a_.force) / h_ + (1 - s) * (1 - 3 * s) * a_.stiffness +
           s * (3 * s - 2) * b_.stiffness;
  }
  /// d2F/dp2 of the Hermite polynomial.
  double curvature(double s) const {
    return (6 * (1 - 2 * s) * (b_.force - a_.force) / h_ + (6 * s - 4) * a_.stiffness + (6 * s - 2) * b_.stiffness) /
           h_;
  }
  double root(bool zero) const {
    const auto value = [&](double s) { return zero ? force(s) : stiffness(s); };
    return common::bisect(value, 0.0, 1.0, 50);
  }

  /// Polynomials through the solutions, and through the slopes, of the up to four nearest points of displacement
  /// control.
  Eigen::VectorXd guess(double p) const { return interpolate(p, &PathPoint::solution); }
  Eigen::VectorXd slopeGuess(double p) const { return interpolate(p, &PathPoint::slope); }
  Eigen::VectorXd interpolate(double p, Eigen::VectorXd PathPoint::*of) const {
    std::vector<const PathPoint*> near = {&a_, &b_};
    const auto add = [&](std::size_t k, const PathPoint& beside) {
      const PathPoint& other = points_[k];
      const bool onward = (other.control - beside.control) * (beside.control - (&beside == &a_ ? b_ : a_).control) > 0;
      if (!other.by_arc && other.negative_pivots == 0 && onward) near.push_back(&other);
    };
    if (k_ > 0) add(k_ - 1, a_);
    if (k_ + 2 < points_.size()) add(k_ + 2, b_);
    Eigen::VectorXd value = Eigen::VectorXd::Zero(a_.solution.size());
    for (const PathPoint* i : near) {
      double weight = 1;
      for (const PathPoint* j : near) {
        if (i != j) weight *= (p - j->control) / (i->control - j->control);
      }
      value += weight * (i->*of);
    }
    return value;
  }

  /// True if the energy differs from that of `a` by more than the work along the branch can.
  bool left(const solver::Equilibrium& x) {
    if (!begun_) solver_.problem().evaluate(a_.solution, solver_.controls(a_.control), solver::Order::ENERGY, at_a_);
    begun_ = true;
    const double dp = x.p(0) - a_.control;
    const double work = 0.5 * dp * (a_.force + x.force()) + dp * dp / 12 * (a_.stiffness - x.stiffness);
    const double size = std::max({std::abs(a_.force), std::abs(b_.force), std::abs(a_.stiffness * h_)});
    const double rounding = 1e-9 * (std::abs(at_a_.energy) + std::abs(x.at.energy));
    return std::abs(x.at.energy - at_a_.energy - work) > 0.05 * std::abs(h_) * size + rounding;
  }

  solver::EquilibriumSolver& solver_;
  const std::vector<PathPoint>& points_;
  std::size_t k_;
  const PathPoint &a_, &b_;
  double h_;
  solver::Evaluation at_a_;
  bool begun_ = false;
};

/// All features between neighbouring points.
class Search {
 public:
  Search(solver::EquilibriumSolver& solver, const std::vector<PathPoint>& points) : solver_(solver), points_(points) {
    double farthest = 0;
    for (const PathPoint& p : points) {
      largest_ = std::max(largest_, std::abs(p.force));
      if (std::abs(p.control) > std::abs(farthest)) farthest = p.control;
    }
    outward_ = farthest >= 0;
  }

  std::vector<Feature> run() {
    for (std::size_t k = 0; k < points_.size(); ++k) {
      // Points that are at rest themselves, as the undeformed one.
      if (rests(points_[k]) && largest_ > 0) {
        found_.push_back({FeatureKind::ZERO, static_cast<int>(k), points_[k], 0, std::abs(points_[k].force)});
      }
      if (k + 1 < points_.size()) between(k);
    }
    return std::move(found_);
  }
  int lost() const { return lost_; }

 private:
  bool rests(const PathPoint& p) const { return std::abs(p.force) <= 1e-9 * largest_; }

  void between(std::size_t k) {
    const PathPoint &a = points_[k], &b = points_[k + 1];
    const bool forward = b.control >= a.control;
    if (a.force * b.force < 0 && !rests(a) && !rests(b)) add(k, true, FeatureKind::ZERO);
    if (a.stiffness * b.stiffness < 0) {
      const bool maximum = (forward ? a : b).stiffness > 0;
      add(k, false, maximum == outward_ ? FeatureKind::PEAK : FeatureKind::VALLEY);
    }
  }

  void add(std::size_t k, bool zero, FeatureKind kind) {
    Feature feature;
    feature.after = static_cast<int>(k);
    feature.kind = kind;
    if (StableInterval(solver_, points_, k).search(zero, feature) || onChord(k, zero, feature)) {
      found_.push_back(feature);
    } else {
      ++lost_;
    }
  }

  bool onChord(std::size_t k, bool zero, Feature& feature) {
    solver::Equilibrium from, to;
    if (!restore(solver_, points_[k], from) || !restore(solver_, points_[k + 1], to)) return false;
    return Interval(solver_, from, to).search(zero, feature);
  }

  solver::EquilibriumSolver& solver_;
  const std::vector<PathPoint>& points_;
  std::vector<Feature> found_;
  double largest_ = 0;
  bool outward_ = true;
  int lost_ = 0;
};

}  // namespace

std::vector<Feature> locateFeatures(solver::EquilibriumSolver& solver, const std::vector<PathPoint>& points,
                                    int* lost) {
  Search search(solver, points);
  std::vector<Feature> found = search.run();
  if (lost != nullptr) *lost = search.lost();
  return found;
}

LocatedFeatures locateFeaturesOf(const solver::Problem& problem, const solver::NewtonSettings& newton,
                                 const std::vector<PathPoint>& points) {
  LocatedFeatures result;
  const double begin = solver::secondsNow();
  // Tighter than the path: an extreme moves by the error of the stiffness over its slope. Where rounding forbids that,
  // as the path.
  for (const double share : {1e-2, 1.0}) {
    solver::NewtonSettings settings = newton;
    settings.relative_tolerance *= share;
    solver::EquilibriumSolver solver(problem, settings);
    int lost = 0;
    result.found = locateFeatures(solver, points, &lost);
    result.factorizations += solver.cholesky().factorizations();
    result.complete = lost == 0;
    if (result.complete) break;
  }
  result.seconds = solver::secondsNow() - begin;
  return result;
}

}  // namespace snapwing::statics
