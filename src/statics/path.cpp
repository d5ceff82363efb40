#include "snapwing/statics/path.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"

namespace snapwing::statics {

namespace {

constexpr int RESTART_EVERY = 10;         ///< targets
constexpr std::size_t FACTOR_EVERY = 4;   ///< targets that a series covers
constexpr std::size_t LEAST_COVERED = 5;  ///< targets for which a series pays
constexpr double SERIES_RESIDUAL = 0.5;   ///< largest one at a series' end, over its tolerance

}  // namespace

PathPoint describePoint(const solver::Equilibrium& x, int iterations, int factorizations, bool keep_solution) {
  PathPoint point;
  point.control = x.p(0);
  point.energy = x.at.elastic_energy;
  point.force = x.force();
  point.stiffness = x.stiffness;
  point.negative_pivots = x.negative_pivots;
  point.stable = x.negative_pivots == 0;
  point.min_det_f = x.at.min_det_f;
  point.iterations = iterations;
  point.factorizations = factorizations;
  if (keep_solution) {
    point.solution = x.z;
    point.slope = x.slope;
    point.multipliers = x.multipliers;
  }
  return point;
}

PathFollower::PathFollower(const solver::Problem& problem, PathSettings settings)
    : settings_(std::move(settings)), solver_(problem, settings_.newton, settings_.line) {
  if (!(settings_.smallest_step > 0 && settings_.smallest_step <= 1)) {
    throw common::Error("smallest_step is " + common::toText(settings_.smallest_step) + "; allowed: (0, 1]");
  }
}

/// The work done on the control must be in the energy of the new point, to the order of a step: corrected trapezium of
/// the force. What is missing was released by a snap to another branch.
bool PathFollower::jumped(const solver::Equilibrium& next) const {
  const double dp = next.p(0) - place_.p(0);
  const double work = 0.5 * dp * (place_.force() + next.force()) + dp * dp / 12 * (place_.stiffness - next.stiffness);
  const double size = std::max({std::abs(place_.force()), std::abs(next.force()), std::abs(place_.stiffness * dp)});
  const double rounding = 1e-9 * (std::abs(place_.at.energy) + std::abs(next.at.energy));
  return std::abs(next.at.energy - place_.at.energy - work) > 0.05 * std::abs(dp) * size + rounding;
}

/// Pivots changed their sign between place_ and next: finds out where and why, and leaves the branch if that is wanted.
/// @param onward  where to go on from
void PathFollower::passSingular(const solver::Equilibrium& next, solver::Equilibrium& onward) {
  SingularPoint found;
  std::string why;
  if (!locateSingular(solver_, place_, next, found, why)) {
    result_.account.push_back("a change of stability was not located: " + why);
    return;
  }
  if (found.kind == SingularKind::BIFURCATION && settings_.perturbation != 0 && found.before == 0) {
    solver::Equilibrium other;
    const solver::NewtonResult result = switchBranch(solver_, found, settings_.perturbation, other);
    result_.iterations += result.iterations;
    result_.factorizations += result.factorizations;
    found.followed = result.converged();
    if (found.followed) {
      onward = other;
    } else {
      result_.account.push_back("the branch along the critical mode was not met: " + result.message);
    }
  }
  result_.singular.push_back(std::move(found));
}

/// A point at the control of `next`, whose z is the guess, with its derivatives.
solver::NewtonResult PathFollower::arrive(solver::Equilibrium& next) {
  solver::NewtonResult result;
  result.status = solver::SolveStatus::CONVERGED;
  on_series_ = settled_ = false;
  if (takeKnown(next)) return result;
  if (settle(next, result)) return result;
  factor_is_ahead_ = false;
  // An unstable branch is no minimum: there only Newton as it is stays on it.
  result = place_.negative_pivots > 0 ? solver_.correct(next) : solver_.minimise(next);
  if (result.converged()) {
    // Where the guess was good enough, the last factor is that of another point.
    result.factorizations += result.iterations == 0 ? solver_.linearise(next)
                                                    : solver_.lineariseNear(next, predictor_.slopeGuess(next.p(0)));
  }
  result_.iterations += result.iterations;
  result_.factorizations += result.factorizations;
  result_.projections += result.projections;
  return result;
}

/// Takes a point of the series: the one ahead as it is, another without a factor of its own.
bool PathFollower::settle(solver::Equilibrium& next, solver::NewtonResult& result) {
  const double p = next.p(0);
  if (!ahead_is_stable_ || !series_->covers(p)) return false;
  if (p == ahead_.p(0)) {
    next = std::move(ahead_);
    ahead_is_stable_ = false;
    result.factorizations = 1;
    result_.factorizations += 1;
    return on_series_ = true;
  }
  on_series_ = settled_ = solver_.settle(series_slope_, next);
  return settled_;
}

/// The points that a series covers are stable if those are that have a factor, one in four and the last one: where the
/// branch turned between them, the series would have a pole.
void PathFollower::lookAhead(const std::vector<double>& targets, std::size_t next) {
  if (!series_ || ahead_is_stable_ || !series_->covers(targets[next]) || place_.negative_pivots != 0) return;
  std::size_t there = next;
  while (there + 1 < targets.size() && there + 1 < next + FACTOR_EVERY && series_->covers(targets[there + 1])) ++there;
  if (there == next) return;
  ahead_ = solver_.start({}, targets[there]);
  series_->at(targets[there], ahead_.z, series_slope_);
  if (!solver_.settle(series_slope_, ahead_)) return;
  ahead_.negative_pivots = solver_.inertia(ahead_);
  ahead_is_stable_ = factor_is_ahead_ = ahead_.negative_pivots == 0;
  ahead_is_last_ = there + 1 == targets.size() || !series_->covers(targets[there + 1]);
}

/// The guess, made of this path's own points, must come to the known one by a hundredth of the step: another branch is
/// not so near, but for a bifurcation's own neighbourhood, where both are one to that accuracy.
bool PathFollower::takeKnown(solver::Equilibrium& next) {
  constexpr double NEAR = 1e-2;
  if (!settings_.known || solver_.constraintCount() > 0 || place_.negative_pivots != 0) return false;
  const PathPoint* known = settings_.known(next.p(0));
  if (known == nullptr || known->by_arc || known->negative_pivots != 0) return false;
  const Eigen::VectorXd& z = known->solution;
  if (z.size() != next.z.size() || known->slope.size() != z.size()) return false;
  if (!((z - next.z).norm() <= NEAR * (z - place_.z).norm())) return false;
  solver::Equilibrium there = solver_.start(z, next.p(0));
  if (!solver_.recall(known->slope, known->negative_pivots, there)) return false;
  next = std::move(there);
  return true;
}

/// A point has an error within the tolerance, which a polynomial of high order makes a hundred times larger: one more
/// step with its factor, or with the one of its guess, takes it away, for what follows and for the record.
void PathFollower::refine(bool has_factor) {
  refined_ = place_.z;
  if (settled_ || (on_series_ && !ahead_is_last_)) return;  // nothing begins here
  if (on_series_) has_factor = factor_is_ahead_;
  if (has_factor && solver_.constraintCount() == 0 && place_.negative_pivots == 0) {
    refined_ -= solver_.cholesky().solve(place_.at.residual);
  }
  if (on_series_) return;  // no guess is made of it
  predictor_.add(place_.p(0), refined_, place_.slope);
}

bool PathFollower::stepTo(double target, solver::NewtonResult& last) {
  const double begin = place_.p(0), whole = target - begin;
  double share = 1, done = 0;
  while (done < 1) {
    share = std::min(share, 1 - done);
    const double p = done + share >= 1 ? target : begin + (done + share) * whole;
    solver::Equilibrium next = solver_.predict(place_, p);
    if (series_ && series_->covers(p)) {
      series_->at(p, next.z, series_slope_);
    } else {
      next.z = predictor_.guess(p);
    }
    last = arrive(next);
    if (last.converged() && settings_.refuse_jumps && jumped(next)) {
      last.status = solver::SolveStatus::JUMPED;
      std::ostringstream text;
      text << "the nearest equilibrium found at " << p << " lies across a jump that releases energy";
      last.message = text.str();
    }
    if (last.converged()) {
      solver::Equilibrium onward;
      const bool changed = next.negative_pivots >= 0 && next.negative_pivots != place_.negative_pivots;
      if (changed && settings_.locate_singular) passSingular(next, onward);
      const bool left = onward.z.size() > 0;
      place_ = left ? std::move(onward) : std::move(next);
      if (left) predictor_.clear();
      if (!on_series_) leaveSeries();
      refine(!changed && last.iterations + last.factorizations > 0);  // else it was known
      done = whole != 0 ? (place_.p(0) - begin) / whole : 1;
      if (!left && p == target) done = 1;
      share *= left ? 1 : 2;
      continue;
    }
    if (last.status == solver::SolveStatus::CANCELLED) return false;
    ++result_.halvings;
    share *= 0.5;
    if (share < settings_.smallest_step) return false;
  }
  return true;
}

/// @return false if the caller wants to stop
bool PathFollower::record(int point, int iterations, int factorizations, bool restart) {
  result_.points.push_back(describePoint(place_, iterations, factorizations, settings_.keep_solutions));
  result_.points.back().restart = restart;
  result_.points.back().by_series = settled_;
  trail_.push_back(describePoint(place_, 0, 0, true));
  trail_.back().solution = refined_;
  if (settings_.keep_solutions) result_.points.back().solution = refined_;
  if (trail_.size() > Predictor::MOST_POINTS + 1) trail_.erase(trail_.begin());
  if (settings_.recorded) settings_.recorded(result_.points.back());
  if (!settings_.progress || !settings_.progress(point)) return true;
  result_.status = solver::SolveStatus::CANCELLED;
  result_.message = "cancelled";
  return false;
}

void PathFollower::stopped(double target, const solver::NewtonResult& last) {
  std::ostringstream text;
  text << "stopped at " << place_.p(0) << " on the way to " << target << ": " << solver::statusName(last.status) << "; "
       << last.message;
  if (result_.halvings > 0) text << "; steps were halved " << result_.halvings << " times";
  result_.status = last.status;
  result_.message = text.str();
}

bool PathFollower::begin(const Eigen::VectorXd& start, double control, solver::NewtonResult& last) {
  place_ = solver_.start(start, control);
  last = solver_.minimise(place_);
  refined_ = place_.z;
  result_.iterations += last.iterations;
  result_.factorizations += last.factorizations + 1;
  if (!last.converged()) return false;
  solver_.linearise(place_);
  if (solver_.supported(place_)) return true;
  last.status = solver::SolveStatus::SINGULAR;
  last.message = solver_.system().deadPoint();
  if (last.message.empty()) {
    last.message = "the Hessian is singular: some body or part is not supported, or joints leave it free to move";
  }
  return false;
}

/// A point that Newton found may be on another branch than the series.
void PathFollower::leaveSeries() {
  if (series_) since_restart_ = RESTART_EVERY;
  series_.reset();
  ahead_is_stable_ = false;
}

bool PathFollower::restartDue(double target) const {
  return series_ ? !series_->covers(target) : since_restart_ >= RESTART_EVERY;
}

/// A series from the place, if it covers enough targets.
void PathFollower::expand(const std::vector<double>& targets, std::size_t next) {
  const std::size_t least = next + LEAST_COVERED - 1;
  if (forces_ == nullptr || least >= targets.size() || place_.negative_pivots != 0) return;
  if (settings_.known && settings_.known(targets[next]) != nullptr) return;
  auto series = std::make_unique<BranchSeries>(*forces_, solver_, place_, targets[least]);
  for (std::size_t last = least; series->covers(targets[last]); last = least) {
    while (last + 1 < targets.size() && series->covers(targets[last + 1])) ++last;
    solver::Equilibrium end = solver_.start({}, targets[last]);
    series->at(targets[last], end.z, series_slope_);
    solver_.evaluate(end, solver::Order::STRESS);
    const double excess = solver_.imbalance(end);
    if (excess <= SERIES_RESIDUAL) {
      series_ = std::move(series);
      ++result_.series;
      return;
    }
    series->shorten(std::max(excess / SERIES_RESIDUAL, 2.0));
  }
}

/// Forgets all that a run which is resumed here does not know.
void PathFollower::restart() {
  since_restart_ = 0;
  series_.reset();
  ahead_is_stable_ = false;
  if (refined_ != place_.z) {
    place_.z = refined_;
    solver_.evaluate(place_);
  }
  result_.factorizations += solver_.restart(place_);
  predictor_.clear();
  for (const PathPoint& point : trail_) {
    if (point.control != place_.p(0)) predictor_.add(point.control, point.solution, point.slope);
  }
  predictor_.add(place_.p(0), place_.z, place_.slope);
}

void PathFollower::followTargets(const std::vector<double>& targets, std::size_t first, solver::NewtonResult& last) {
  series_.reset();
  since_restart_ = RESTART_EVERY;
  if (settings_.series && solver_.constraintCount() == 0 && targets.size() - first >= LEAST_COVERED) {
    forces_ = solver_.problem().series(BranchSeries::order(), result_.no_series);
  }
  for (std::size_t k = first; k < targets.size(); ++k) {
    if (restartDue(targets[k])) {
      restart();
      expand(targets, k);
    }
    lookAhead(targets, k);
    const int before = result_.iterations, factorizations = result_.factorizations;
    if (!stepTo(targets[k], last)) return stopped(targets[k], last);
    ++since_restart_;
    const bool restarts = k + 1 < targets.size() && restartDue(targets[k + 1]);
    if (!record(static_cast<int>(k), result_.iterations - before, result_.factorizations - factorizations, restarts)) {
      return;
    }
  }
}

PathResult PathFollower::finish(double begin) {
  result_.factorizations = solver_.cholesky().factorizations() - factorizations_before_;  // with those of detours
  result_.seconds = solver::secondsNow() - begin;
  result_.seconds_assembly = solver_.secondsAssembly();
  result_.seconds_factor = solver_.cholesky().secondsFactor();
  result_.seconds_solve = solver_.cholesky().secondsSolve();
  result_.seconds_analysis = solver_.cholesky().secondsAnalysis();
  return std::move(result_);
}

PathResult PathFollower::follow(const Eigen::VectorXd& start, const std::vector<double>& targets) {
  if (targets.empty()) throw common::Error("a path needs at least one target");
  result_ = {};
  trail_.clear();
  factorizations_before_ = solver_.cholesky().factorizations();
  const double now = solver::secondsNow();
  solver::NewtonResult last;
  result_.status = solver::SolveStatus::CONVERGED;
  if (!begin(start, targets[0], last)) {
    stopped(targets[0], last);
  } else if (record(0, result_.iterations, result_.factorizations, true)) {
    followTargets(targets, 1, last);
  }
  return finish(now);
}

PathResult PathFollower::followFrom(const solver::Equilibrium& start, const std::vector<double>& targets,
                                    const std::vector<PathPoint>& trail) {
  result_ = {};
  const std::size_t kept = std::min(trail.size(), Predictor::MOST_POINTS + 1);
  trail_.assign(trail.end() - static_cast<std::ptrdiff_t>(kept), trail.end());
  factorizations_before_ = solver_.cholesky().factorizations();
  const double now = solver::secondsNow();
  solver::NewtonResult last;
  result_.status = solver::SolveStatus::CONVERGED;
  place_ = start;
  refined_ = place_.z;
  followTargets(targets, 0, last);
  return finish(now);
}

}  // namespace snapwing::statics
