#include "snapwing/statics/automatic.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "snapwing/common/error.h"

namespace snapwing::statics {

namespace {

/// Targets that lie beyond a control, in the direction of the path.
std::vector<double> beyond(double control, const std::vector<double>& targets) {
  const double direction = targets.back() >= targets.front() ? 1 : -1;
  const double slack = 1e-12 * std::abs(targets.back() - targets.front());
  std::vector<double> rest;
  for (const double target : targets) {
    if ((target - control) * direction > slack) rest.push_back(target);
  }
  return rest;
}

void append(PathResult& whole, PathResult&& part) {
  const auto move = [](auto& from, auto& to) {
    to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
  };
  move(part.points, whole.points);
  move(part.singular, whole.singular);
  move(part.account, whole.account);
  whole.status = part.status;
  whole.message = part.message;
  whole.iterations += part.iterations;
  whole.factorizations += part.factorizations;
  whole.projections += part.projections;
  whole.halvings += part.halvings;
  whole.series += part.series;
  if (whole.no_series.empty()) whole.no_series = part.no_series;
}

class AutomaticFollower {
 public:
  AutomaticFollower(const solver::Problem& problem, const AutomaticSettings& settings,
                    const std::vector<double>& targets)
      : settings_(settings), targets_(targets), follower_(problem, strict(settings)), begin_(solver::secondsNow()) {
    if (targets.size() < 2) throw common::Error("an automatic path needs at least two targets");
  }

  PathResult fromStart(const Eigen::VectorXd& start) {
    first_z_ = start;
    first_p_ = targets_.front();
    whole_ = follower_.follow(start, targets_);
    return goOn();
  }

  PathResult fromPoints(const Eigen::VectorXd& start, const std::vector<PathPoint>& before) {
    resumed_ = true;
    const PathPoint& from = before.back();
    solver::EquilibriumSolver& solver = follower_.solver();
    solver::Equilibrium x = solver.start(from.solution, from.control);
    x.multipliers = from.multipliers;
    const solver::NewtonResult result = solver.correct(x);
    if (!result.converged()) {
      whole_.status = result.status;
      whole_.message = "the restart point is not an equilibrium: " + result.message;
      return finish();
    }
    first_z_ = start;
    first_p_ = targets_.front();
    // An arc begins a path of its own.
    const auto arc = std::find_if(before.rbegin(), before.rend(), [](const PathPoint& point) { return point.by_arc; });
    whole_ = follower_.followFrom(x, beyond(from.control, targets_), std::vector<PathPoint>(arc.base(), before.end()));
    return goOn();
  }

 private:
  static PathSettings strict(const AutomaticSettings& settings) {
    PathSettings path = settings.path;
    path.refuse_jumps = path.refuse_jumps || settings.arc_on_failure;
    return path;
  }

  bool failed() const {
    return whole_.status != solver::SolveStatus::CONVERGED && whole_.status != solver::SolveStatus::CANCELLED;
  }

  PathResult goOn() {
    // Not before a first point: what is not supported has no branch.
    while (failed() && settings_.arc_on_failure && (resumed_ || !whole_.points.empty())) {
      const solver::Equilibrium from = follower_.place();
      const std::vector<double> rest = beyond(from.p(0), targets_);
      if (rest.empty()) break;
      whole_.account.push_back("displacement control " + whole_.message);
      if (!arcTo(rest, from)) break;
      const std::vector<double> more = beyond(last_.p(0), targets_);
      if (more.empty()) break;
      append(whole_, follower_.followFrom(last_, more));
    }
    return finish();
  }

  bool arcTo(const std::vector<double>& rest, const solver::Equilibrium& from) {
    ArcSettings arc;
    arc.newton = settings_.path.newton;
    const double range = std::abs(targets_.back() - targets_.front());
    const double step = std::abs(rest.front() - from.p(0)) + range / static_cast<double>(targets_.size());
    arc.first_step = 0.05 * step;
    arc.largest_step = 0.5 * step;
    arc.smallest_step = 1e-6 * step;
    arc.max_points = settings_.largest_arc;
    arc.end = rest.front();
    const double direction = targets_.back() >= targets_.front() ? 1 : -1;
    arc.turn_back = targets_.front() * direction - settings_.turn_back * range;
    arc.perturbation = settings_.path.perturbation;
    arc.locate_singular = settings_.path.locate_singular;
    arc.recorded = settings_.path.recorded;
    // Shares of motion and control as on the path so far: near a fold the tangent says nothing of it.
    const double moved = (from.z - first_z_).squaredNorm(), driven = from.p(0) - first_p_;
    if (moved > 0 && driven != 0) arc.weight = driven * driven / moved;
    arc.progress = [this](int, double) { return settings_.path.newton.cancelled && settings_.path.newton.cancelled(); };
    ArcResult result = followArcFrom(follower_.solver(), from, arc);
    std::ostringstream text;
    text << "arc length from " << from.p(0);
    const bool there = result.path.status == solver::SolveStatus::CONVERGED && result.path.message.empty();
    if (there) {
      text << " came to " << result.last.p(0) << " in " << result.path.points.size() << " points";
      text << (result.limit_points.empty() ? ", no limit point of the control" : ", limit points near");
      for (const int k : result.limit_points) text << " " << result.path.points[std::max(k, 0)].control;
    } else {
      text << " failed as well: " << result.path.message;
    }
    result.path.account.push_back(text.str());
    if (!there) {
      // A branch that turned back for good is no way on: what stopped displacement control is then the reason.
      if (result.path.status == solver::SolveStatus::CONVERGED) result.path.status = whole_.status;
      result.path.message = whole_.message + "; " + text.str();
    }
    last_ = result.last;
    append(whole_, std::move(result.path));
    return there;
  }

  PathResult finish() {
    const solver::EquilibriumSolver& solver = follower_.solver();
    whole_.factorizations = solver.cholesky().factorizations();
    whole_.seconds = solver::secondsNow() - begin_;
    whole_.seconds_assembly = solver.secondsAssembly();
    whole_.seconds_factor = solver.cholesky().secondsFactor();
    whole_.seconds_solve = solver.cholesky().secondsSolve();
    whole_.seconds_analysis = solver.cholesky().secondsAnalysis();
    return std::move(whole_);
  }

  const AutomaticSettings& settings_;
  const std::vector<double>& targets_;
  PathFollower follower_;
  double begin_, first_p_ = 0;
  bool resumed_ = false;
  Eigen::VectorXd first_z_;
  solver::Equilibrium last_;
  PathResult whole_;
};

}  // namespace

PathResult followAutomatically(const solver::Problem& problem, const Eigen::VectorXd& start,
                               const std::vector<double>& targets, const AutomaticSettings& settings) {
  return AutomaticFollower(problem, settings, targets).fromStart(start);
}

PathResult continueAutomatically(const solver::Problem& problem, const Eigen::VectorXd& start,
                                 const std::vector<PathPoint>& before, const std::vector<double>& targets,
                                 const AutomaticSettings& settings) {
  return AutomaticFollower(problem, settings, targets).fromPoints(start, before);
}

std::vector<int> turningPoints(const std::vector<PathPoint>& points) {
  std::vector<int> result;
  for (std::size_t k = 1; k + 1 < points.size(); ++k) {
    const double before = points[k].control - points[k - 1].control, after = points[k + 1].control - points[k].control;
    if (before * after < 0) result.push_back(static_cast<int>(k));
  }
  return result;
}

std::vector<int> stabilityChanges(const std::vector<PathPoint>& points) {
  std::vector<int> result;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    if (points[k].negative_pivots != points[k + 1].negative_pivots) result.push_back(static_cast<int>(k));
  }
  return result;
}

}  // namespace snapwing::statics
