#include "snapwing/statics/arc_length.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "snapwing/common/error.h"

namespace snapwing::statics {

namespace {

class ArcFollower {
 public:
  ArcFollower(const Problem& problem, const ArcSettings& settings)
      : problem_(problem), settings_(settings), cholesky_(problem.pattern()) {}

  ArcResult run(const Eigen::VectorXd& start, double p0) {
    const double begin = secondsNow();
    const double direction = settings_.end >= p0 ? 1 : -1;
    const double longest = settings_.largest_step > 0 ? settings_.largest_step : 10 * settings_.first_step;
    const double shortest = settings_.smallest_step > 0 ? settings_.smallest_step : 1e-6 * settings_.first_step;
    z_ = start;
    p_ = p0;
    if (!correctAtFixedControl()) return finish(SolveStatus::NOT_SOLVED, "the start is no equilibrium", begin);
    w_ = 1 / std::max(slope_.squaredNorm(), 1e-300);
    setDirection(direction);
    record(0);
    double ds = settings_.first_step;
    while (static_cast<int>(result_.path.points.size()) < settings_.max_points) {
      const int iterations = step(ds);
      if (iterations < 0) {
        ++result_.path.halvings;
        ds *= 0.5;
        if (ds < shortest) return finish(SolveStatus::NOT_SOLVED, "arc-length steps became too short", begin);
        continue;
      }
      record(iterations);
      if (settings_.progress && settings_.progress(static_cast<int>(result_.path.points.size()), p_)) {
        return finish(SolveStatus::CANCELLED, "cancelled", begin);
      }
      if ((p_ - settings_.end) * direction >= 0 || p_ * direction < settings_.turn_back) {
        return finish(SolveStatus::CONVERGED, "", begin);
      }
      ds = std::min(longest, ds * std::min(2.0, std::max(0.5, std::sqrt(4.0 / std::max(iterations, 1)))));
    }
    return finish(SolveStatus::ITERATION_LIMIT, "ran out of points", begin);
  }

 private:
  bool factorize() {
    ++result_.path.factorizations;
    negative_ = 0;
    if (cholesky_.factorize(at_.hessian)) return true;
    ++result_.path.factorizations;
    negative_ = cholesky_.factorizeIndefinite(at_.hessian);
    return negative_ >= 0;
  }
  /// Evaluation, factor, and dz/dp at (z, p).
  bool prepare(const Eigen::VectorXd& z, double p) {
    problem_.evaluate(z, Eigen::VectorXd::Constant(1, p), Order::TANGENT, at_);
    if (!at_.finite || !factorize()) return false;
    Eigen::VectorXd free_part;
    problem_.controlTangent(at_, Eigen::VectorXd::Ones(1), free_part, control_part_);
    slope_ = -cholesky_.solve(free_part);
    stiffness_ = control_part_(0) + free_part.dot(slope_);
    return slope_.allFinite();
  }
  bool small() const {
    return at_.residual.norm() <=
           std::max(settings_.newton.relative_tolerance * at_.force_scale, problem_.forceFloor());
  }

  bool correctAtFixedControl() {
    for (int i = 0; i <= settings_.newton.max_iterations; ++i) {
      if (!prepare(z_, p_)) return false;
      if (small()) return true;
      z_ -= cholesky_.solve(at_.residual);
    }
    return false;
  }

  /// Unit tangent (in the weighted norm) at the current point, pointing along the last one.
  void setDirection(double sign) {
    const double length = std::sqrt(w_ * slope_.squaredNorm() + 1);
    t_z_ = sign * slope_ / length;
    t_p_ = sign / length;
  }

  /// @return iterations, or -1 if the corrector failed; the place is then as before
  int step(double ds) {
    const Eigen::VectorXd z0 = z_, t_z0 = t_z_;
    const double p0 = p_, t_p0 = t_p_;
    Eigen::VectorXd z = z0 + ds * t_z0;
    double p = p0 + ds * t_p0;
    for (int i = 1; i <= std::min(settings_.newton.max_iterations, 15); ++i) {
      ++result_.path.iterations;
      if (!prepare(z, p)) return -1;
      if (small()) {
        z_ = z;
        p_ = p;
        const double along = w_ * t_z0.dot(slope_) + t_p0;
        setDirection(along >= 0 ? 1 : -1);
        return i;
      }
      const Eigen::VectorXd a = -cholesky_.solve(at_.residual);
      const double gap = ds - w_ * t_z0.dot(z - z0) - t_p0 * (p - p0);
      const double dp = (gap - w_ * t_z0.dot(a)) / (w_ * t_z0.dot(slope_) + t_p0);
      if (!std::isfinite(dp)) return -1;
      z += a + dp * slope_;
      p += dp;
    }
    return -1;
  }

  void record(int iterations) {
    PathPoint point;
    point.control = p_;
    point.energy = at_.elastic_energy;
    point.force = at_.control_force(0);
    point.stiffness = stiffness_;
    point.negative_pivots = negative_;
    point.stable = negative_ == 0;
    point.min_det_f = at_.min_det_f;
    point.iterations = iterations;
    point.solution = z_;
    auto& points = result_.path.points;
    if (!points.empty()) {
      const int last = static_cast<int>(points.size()) - 1;
      if (points.back().negative_pivots != negative_) result_.crossings.push_back(last);
      if (last_t_p_ * t_p_ < 0) result_.limit_points.push_back(last);
    }
    last_t_p_ = t_p_;
    points.push_back(std::move(point));
  }

  ArcResult finish(SolveStatus status, const std::string& message, double begin) {
    result_.path.status = status;
    if (!message.empty()) {
      std::ostringstream text;
      text << message << " at control " << p_ << ", |r| = " << (at_.finite ? at_.residual.norm() : -1) << " N";
      result_.path.message = text.str();
    }
    result_.path.seconds = secondsNow() - begin;
    result_.path.seconds_factor = cholesky_.secondsFactor();
    result_.path.seconds_solve = cholesky_.secondsSolve();
    result_.path.seconds_analysis = cholesky_.secondsAnalysis();
    return std::move(result_);
  }

  const Problem& problem_;
  const ArcSettings& settings_;
  Cholesky cholesky_;
  Evaluation at_;
  Eigen::VectorXd z_, slope_, t_z_, control_part_;
  double p_ = 0, w_ = 1, t_p_ = 1, last_t_p_ = 1, stiffness_ = 0;
  int negative_ = 0;
  ArcResult result_;
};

}  // namespace

ArcResult followArc(const Problem& problem, const Eigen::VectorXd& start, double p0, const ArcSettings& settings) {
  if (problem.controlCount() != 1) throw common::Error("an arc needs a problem with exactly one control");
  if (!(settings.first_step > 0))
    throw common::Error("first_step is " + std::to_string(settings.first_step) + "; allowed: > 0");
  if (settings.max_points < 2)
    throw common::Error("max_points is " + std::to_string(settings.max_points) + "; allowed: >= 2");
  return ArcFollower(problem, settings).run(start, p0);
}

}  // namespace snapwing::statics
