#include "snapwing/statics/arc_length.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"

namespace snapwing::statics {

namespace {

// Largest correction in steps, least cosine between steps; shorter steps than this share of the first are not judged.
constexpr double FARTHEST_CORRECTION = 0.3, SHARPEST_TURN = 0.8, SHORT_ENOUGH = 1e-3;

class ArcFollower {
 public:
  ArcFollower(solver::EquilibriumSolver& solver, const ArcSettings& settings) : solver_(solver), settings_(settings) {}

  /// @param fresh  the start is a first guess at a point that is to be recorded
  ArcResult run(const solver::Equilibrium& start, bool fresh) {
    begin_ = solver::secondsNow();
    factorizations_before_ = solver_.cholesky().factorizations();
    x_ = start;
    const double direction = settings_.end >= x_.p(0) ? 1 : -1;
    if (fresh) {
      const solver::NewtonResult result = solver_.correct(x_);
      count(result);
      if (!result.converged()) return finish(result.status, "the start is not an equilibrium: " + result.message);
    }
    w_ = settings_.weight > 0 ? settings_.weight : 1 / std::max(x_.slope.squaredNorm(), 1e-300);
    setDirection(x_.slope, direction);
    last_t_p_ = t_p_;
    last_negative_ = x_.negative_pivots;
    if (fresh) record(0);
    return march(direction);
  }

 private:
  ArcResult march(double direction) {
    const double longest = settings_.largest_step > 0 ? settings_.largest_step : 10 * settings_.first_step;
    const double shortest = settings_.smallest_step > 0 ? settings_.smallest_step : 1e-6 * settings_.first_step;
    double ds = settings_.first_step;
    while (static_cast<int>(result_.path.points.size()) < settings_.max_points) {
      const solver::NewtonResult moved = step(ds, direction);
      if (moved.status == solver::SolveStatus::CANCELLED) return finish(solver::SolveStatus::CANCELLED, "cancelled");
      if (!moved.converged()) {
        ++result_.path.halvings;
        ds *= 0.5;
        if (ds < shortest) return finish(moved.status, "arc-length steps became too short: " + moved.message);
        continue;
      }
      record(moved.iterations);
      if (settings_.progress && settings_.progress(static_cast<int>(result_.path.points.size()), x_.p(0))) {
        return finish(solver::SolveStatus::CANCELLED, "cancelled");
      }
      if ((x_.p(0) - settings_.end) * direction >= 0) return finish(solver::SolveStatus::CONVERGED, "");
      if (x_.p(0) * direction < settings_.turn_back) {
        return finish(solver::SolveStatus::CONVERGED, "the branch turned back");
      }
      ds = std::min(longest, ds * std::min(2.0, std::max(0.5, std::sqrt(4.0 / std::max(moved.iterations, 1)))));
    }
    return finish(solver::SolveStatus::ITERATION_LIMIT, "ran out of points");
  }

  void count(const solver::NewtonResult& result) {
    result_.path.iterations += result.iterations;
    result_.path.factorizations += result.factorizations;
  }

  /// Unit tangent (in the weighted norm) at the current point.
  void setDirection(const Eigen::VectorXd& slope, double sign) {
    const double length = std::sqrt(w_ * slope.squaredNorm() + 1);
    t_z_ = sign * slope / length;
    t_p_ = sign / length;
  }

  /// The place is as before if the corrector fails.
  solver::NewtonResult step(double ds, double direction) {
    solver::BranchPlane plane;
    plane.origin = x_.z;
    plane.normal = w_ * t_z_;
    plane.control = x_.p(0);
    plane.control_normal = t_p_;
    plane.distance = ds;
    solver::Equilibrium next = solver_.predict(x_, x_.p(0) + ds * t_p_);
    next.z = x_.z + ds * t_z_;
    const Eigen::VectorXd guess = next.z;
    const double guess_p = next.p(0);
    solver::NewtonResult result = solver_.correctOn(plane, next);
    count(result);
    if (!result.converged()) return result;
    // A long way from the tangent is a step too long, or another branch.
    const double moved = next.p(0) - guess_p;
    const double off = std::sqrt(w_ * (next.z - guess).squaredNorm() + moved * moved);
    const bool far = off > FARTHEST_CORRECTION * ds;
    if ((next.p(0) - settings_.end) * direction > 0) land(next);
    double along = w_ * t_z_.dot(next.slope) + t_p_;
    const double turn = std::abs(along) / std::sqrt(w_ * next.slope.squaredNorm() + 1);
    if ((far || turn < SHARPEST_TURN) && ds > SHORT_ENOUGH * settings_.first_step) {
      result.status = solver::SolveStatus::JUMPED;
      result.message = "the branch turns too sharply for the step";
      return result;
    }
    passSingular(next, along);
    setDirection(x_.slope, along >= 0 ? 1 : -1);
    return result;
  }

  /// Replaces a point beyond the end by the one at the end, unless the branch cannot be met there.
  void land(solver::Equilibrium& next) {
    solver::Equilibrium at_end = solver_.predict(next, settings_.end);
    const solver::NewtonResult result = solver_.correct(at_end);
    count(result);
    if (result.converged() && at_end.negative_pivots == next.negative_pivots) next = std::move(at_end);
  }

  /// @param along  in and out: whether the control grows along the way onward
  void passSingular(solver::Equilibrium& next, double& along) {
    const bool changed = next.negative_pivots != x_.negative_pivots;
    if (changed && settings_.locate_singular) {
      SingularPoint found;
      std::string why;
      if (locateSingular(solver_, x_, next, found, why)) {
        solver::Equilibrium other;
        if (found.kind == SingularKind::BIFURCATION && settings_.perturbation != 0 && found.before == 0) {
          const solver::NewtonResult result = switchBranch(solver_, found, settings_.perturbation, other);
          count(result);
          found.followed = result.converged();
        }
        if (found.followed) {
          along = w_ * other.slope.dot(other.z - found.point.z) + other.p(0) - found.point.p(0);
          next = std::move(other);
        }
        result_.path.singular.push_back(std::move(found));
      } else {
        result_.path.account.push_back("a change of stability was not located: " + why);
      }
    }
    x_ = std::move(next);
  }

  void record(int iterations) {
    PathPoint point = describePoint(x_, iterations, result_.path.factorizations - last_factorizations_, true);
    point.by_arc = true;
    auto& points = result_.path.points;
    const int last = static_cast<int>(points.size()) - 1;
    if (last_negative_ != x_.negative_pivots) result_.crossings.push_back(last);
    if (last_t_p_ * t_p_ < 0) result_.limit_points.push_back(last);
    last_t_p_ = t_p_;
    last_factorizations_ = result_.path.factorizations;
    last_negative_ = x_.negative_pivots;
    if (settings_.recorded) settings_.recorded(point);
    points.push_back(std::move(point));
  }

  ArcResult finish(solver::SolveStatus status, const std::string& message) {
    result_.path.status = status;
    if (!message.empty()) {
      std::ostringstream text;
      text << message << " at control " << x_.p(0);
      result_.path.message = text.str();
    }
    result_.path.factorizations = solver_.cholesky().factorizations() - factorizations_before_;
    result_.path.seconds = solver::secondsNow() - begin_;
    result_.path.seconds_assembly = solver_.secondsAssembly();
    result_.path.seconds_factor = solver_.cholesky().secondsFactor();
    result_.path.seconds_solve = solver_.cholesky().secondsSolve();
    result_.path.seconds_analysis = solver_.cholesky().secondsAnalysis();
    result_.last = x_;
    return std::move(result_);
  }

  solver::EquilibriumSolver& solver_;
  const ArcSettings& settings_;
  solver::Equilibrium x_;
  Eigen::VectorXd t_z_;
  double begin_ = 0, w_ = 1, t_p_ = 1, last_t_p_ = 1;
  int last_negative_ = 0, last_factorizations_ = 0, factorizations_before_ = 0;
  ArcResult result_;
};

void validate(const ArcSettings& settings) {
  if (!(settings.first_step > 0))
    throw common::Error("first_step is " + common::toText(settings.first_step) + "; allowed: > 0");
  if (settings.max_points < 2)
    throw common::Error("max_points is " + std::to_string(settings.max_points) + "; allowed: >= 2");
}

}  // namespace

ArcResult followArc(const solver::Problem& problem, const Eigen::VectorXd& start, double p0,
                    const ArcSettings& settings) {
  if (problem.controlCount() != 1) throw common::Error("an arc needs a problem with exactly one control");
  validate(settings);
  solver::EquilibriumSolver solver(problem, settings.newton);
  return ArcFollower(solver, settings).run(solver.start(start, p0), true);
}

ArcResult followArcFrom(solver::EquilibriumSolver& solver, const solver::Equilibrium& start,
                        const ArcSettings& settings) {
  validate(settings);
  return ArcFollower(solver, settings).run(start, false);
}

}  // namespace snapwing::statics
