#include "snapwing/statics/path.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "snapwing/common/error.h"

namespace snapwing::statics {

/// A converged point with its tangent along the path.
struct PathFollower::Place {
  Eigen::VectorXd p = Eigen::VectorXd::Zero(1);
  Eigen::VectorXd z;
  Evaluation at;
  Eigen::VectorXd slope;  ///< dz/dp
  double stiffness = 0;
  int negative_pivots = 0;
};

PathFollower::PathFollower(const Problem& problem, PathSettings settings)
    : problem_(problem), settings_(std::move(settings)), newton_(problem, settings_.newton) {
  if (problem.controlCount() != 1) throw common::Error("a path needs a problem with exactly one control");
  if (!(settings_.smallest_step > 0 && settings_.smallest_step <= 1)) {
    throw common::Error("smallest_step is " + std::to_string(settings_.smallest_step) + "; allowed: (0, 1]");
  }
}

/// Stability and tangent at a converged point: dz/dp = -H^-1 d2Pi/dzdp, stiffness by the Schur complement.
void PathFollower::settle(Place& place) {
  Eigen::VectorXd free_part, control_part;
  problem_.controlTangent(place.at, Eigen::VectorXd::Ones(1), free_part, control_part);
  Cholesky& cholesky = newton_.cholesky();
  place.negative_pivots = 0;
  if (!cholesky.factorize(place.at.hessian)) place.negative_pivots = cholesky.factorizeIndefinite(place.at.hessian);
  place.slope = Eigen::VectorXd::Zero(place.z.size());
  if (place.negative_pivots >= 0) {
    const Eigen::VectorXd slope = -cholesky.solve(free_part);
    if (slope.allFinite()) place.slope = slope;
  }
  place.stiffness = control_part(0) + free_part.dot(place.slope);
}

/// Bodies that can move freely leave a Hessian whose smallest pivot is rounding.
bool PathFollower::supported(const Place& place, NewtonResult& last) {
  if (place.negative_pivots >= 0 && newton_.cholesky().reciprocalCondition() > 1e-15) return true;
  last.status = SolveStatus::SINGULAR;
  last.message = "the Hessian is singular: some body or part is not supported, or joints leave it free to move";
  return false;
}

PathPoint PathFollower::describe(const Place& place, int iterations) const {
  PathPoint point;
  point.control = place.p(0);
  point.energy = place.at.elastic_energy;
  point.force = place.at.control_force(0);
  point.stiffness = place.stiffness;
  point.negative_pivots = place.negative_pivots;
  point.stable = place.negative_pivots == 0;
  point.min_det_f = place.at.min_det_f;
  point.iterations = iterations;
  if (settings_.keep_solutions) point.solution = place.z;
  return point;
}

bool PathFollower::stepTo(double target, Place& place, PathResult& result, NewtonResult& last) {
  const double whole = target - place.p(0);
  double share = 1, done = 0;
  const double begin = place.p(0);
  while (done < 1) {
    share = std::min(share, 1 - done);
    Eigen::VectorXd p(1);
    p(0) = done + share >= 1 ? target : begin + (done + share) * whole;
    Eigen::VectorXd z = place.z + (p(0) - place.p(0)) * place.slope;
    Evaluation at;
    last = newton_.solve(p, z, at);
    result.iterations += last.iterations;
    result.factorizations += last.factorizations;
    result.projections += last.projections;
    if (last.converged()) {
      place.p = p;
      place.z = std::move(z);
      std::swap(place.at, at);
      settle(place);
      ++result.factorizations;
      done += share;
      share *= 2;
      continue;
    }
    if (last.status == SolveStatus::CANCELLED) return false;
    ++result.halvings;
    share *= 0.5;
    if (share < settings_.smallest_step) return false;
  }
  return true;
}

PathResult PathFollower::follow(const Eigen::VectorXd& start, const std::vector<double>& targets) {
  if (targets.empty()) throw common::Error("a path needs at least one target");
  PathResult result;
  const double begin = secondsNow();
  Place place;
  place.p(0) = targets[0];
  place.z = start;
  NewtonResult last;
  result.status = SolveStatus::CONVERGED;
  for (std::size_t k = 0; k < targets.size(); ++k) {
    const int before = result.iterations;
    bool good = false;
    if (k == 0) {
      last = newton_.solve(place.p, place.z, place.at);
      result.iterations += last.iterations;
      result.factorizations += last.factorizations + 1;
      if ((good = last.converged())) {
        settle(place);
        good = supported(place, last);
      }
    } else {
      good = stepTo(targets[k], place, result, last);
    }
    if (!good) {
      std::ostringstream text;
      text << "stopped at " << place.p(0) << " on the way to " << targets[k] << ": " << statusName(last.status) << "; "
           << last.message;
      result.status = last.status;
      result.message = text.str();
      break;
    }
    result.points.push_back(describe(place, result.iterations - before));
    if (settings_.progress && settings_.progress(static_cast<int>(k))) {
      result.status = SolveStatus::CANCELLED;
      result.message = "cancelled";
      break;
    }
  }
  result.seconds = secondsNow() - begin;
  result.seconds_assembly = newton_.secondsAssembly();
  result.seconds_factor = newton_.cholesky().secondsFactor();
  result.seconds_solve = newton_.cholesky().secondsSolve();
  result.seconds_analysis = newton_.cholesky().secondsAnalysis();
  return result;
}

}  // namespace snapwing::statics
