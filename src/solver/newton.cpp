#include "snapwing/solver/newton.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <utility>

#include "conjugate_gradients.h"
#include "snapwing/common/enum_names.h"
#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"

namespace snapwing::solver {

namespace {

constexpr std::size_t MOST_SECANTS = 8;
constexpr int OLD_FACTOR_STEPS = 8;  ///< with the factor of another point, fewer do not help
constexpr int OLD_FACTOR_PAUSE = 3;  ///< factorizations before the next try, after one that was in vain
/// Share to which an iteration must reduce the residual for the next one to reuse the factor. On solids of 1.25 and
/// 1 mm .25 to .4 cost the same.
constexpr double KEPT_FACTOR_SERVES = 0.3;

/// Q of d = Q d0: from one place to another. With one displacement eliminated the node turns about its axis.
std::vector<NodeRotation> turnsBetween(const std::vector<NodeRotation>& before, const std::vector<NodeRotation>& now) {
  std::vector<NodeRotation> turns;
  if (before.size() != now.size()) return turns;
  for (std::size_t n = 0; n < now.size(); ++n) {
    const std::array<int, 3>& free = now[n].free;
    const Eigen::Matrix3d whole = now[n].rotation * before[n].rotation.transpose();
    const auto eliminated = std::count(free.begin(), free.end(), -1);
    if (eliminated == 0) turns.push_back({free, whole});
    if (eliminated != 1) continue;
    const int axis = static_cast<int>(std::find(free.begin(), free.end(), -1) - free.begin());
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    const double cosine = whole(a, a) + whole(b, b), sine = whole(b, a) - whole(a, b);
    const double size = std::sqrt(cosine * cosine + sine * sine);
    if (!(size > 0)) continue;
    Eigen::Matrix3d about = Eigen::Matrix3d::Identity();
    about(a, a) = about(b, b) = cosine / size;
    about(b, a) = sine / size;
    about(a, b) = -sine / size;
    turns.push_back({free, about});
  }
  return turns;
}

/// x := Q x, or Q^T x.
void turn(const std::vector<NodeRotation>& turns, bool back, Eigen::VectorXd& x) {
  for (const NodeRotation& node : turns) {
    Eigen::Vector3d own = Eigen::Vector3d::Zero();
    for (int a = 0; a < 3; ++a) own(a) = node.free[a] >= 0 ? x(node.free[a]) : 0;
    own = back ? Eigen::Vector3d(node.rotation.transpose() * own) : Eigen::Vector3d(node.rotation * own);
    for (int a = 0; a < 3; ++a) {
      if (node.free[a] >= 0) x(node.free[a]) = own(a);
    }
  }
}

}  // namespace

std::string statusName(SolveStatus status) {
  switch (status) {
    case SolveStatus::NOT_SOLVED:
      return "not solved";
    case SolveStatus::CONVERGED:
      return "converged";
    case SolveStatus::ITERATION_LIMIT:
      return "iteration limit";
    case SolveStatus::INVERTED_START:
      return "first guess inverts an element (det F <= 0)";
    case SolveStatus::LINE_SEARCH_FAILED:
      return "line search failed";
    case SolveStatus::SINGULAR:
      return "singular";
    case SolveStatus::CANCELLED:
      return "cancelled";
    case SolveStatus::JUMPED:
      return "jumped to another branch";
  }
  return "unknown";
}

Projection projectionFromName(const std::string& name) {
  static constexpr common::EnumNames<Projection, 3> NAMES("projection", {"on_demand", "clamp", "absolute"});
  return NAMES.value(name);
}

void NewtonSettings::validate() const {
  if (max_iterations < 1)
    throw common::Error("max_iterations is " + std::to_string(max_iterations) + "; allowed: >= 1");
  if (!(relative_tolerance > 0 && relative_tolerance <= 1e-2)) {
    throw common::Error("relative_tolerance is " + common::toText(relative_tolerance) + "; allowed: (0, 0.01]");
  }
  if (!(roundings >= 1)) throw common::Error("roundings is " + common::toText(roundings) + "; allowed: >= 1");
}

Newton::Newton(const Problem& problem, NewtonSettings settings)
    : problem_(problem), settings_(std::move(settings)), cholesky_(problem.pattern()) {
  settings_.validate();
}

void Newton::evaluate(const Eigen::VectorXd& z, const Held& held, Order order, Evaluation& at) {
  const double begin = secondsNow();
  if (held.multipliers.size() == 0) {
    problem_->evaluate(z, held.p, order, at);
  } else {
    problem_->evaluateLagrangian(z, held.p, held.multipliers, order, at);
  }
  seconds_assembly_ += secondsNow() - begin;
}

double residualTolerance(const Problem& problem, const Evaluation& at, const NewtonSettings& settings) {
  return std::max(
      {settings.relative_tolerance * at.force_scale, settings.roundings * at.rounding, problem.forceFloor()});
}

double Newton::tolerance(const Evaluation& at) const { return residualTolerance(*problem_, at, settings_); }

/// Direction by conjugate gradients with the factor of an earlier point, if that is nearer than a new factor is cheap.
bool Newton::nearby(const Evaluation& at, Eigen::VectorXd& d, NewtonResult& result) {
  if (settings_.projection != Projection::ON_DEMAND || !cholesky_.definite() || !old_factor_serves_) return false;
  // Exact enough for Newton's convergence to stay what it is, and no more exact than the end asks for.
  const double norm = at.residual.norm();
  const double wanted = std::max(0.1 * tolerance(at), 1e-3 * norm);
  // A step of conjugate gradients costs a solve and a product with the matrix.
  const int worth = static_cast<int>(0.5 * cholesky_.factorCostInSolves());
  if (!factor_is_recent_ && (worth < OLD_FACTOR_STEPS || patience_-- > 0)) return false;
  const int limit = std::max(worth, 4);
  d.resize(0);
  const CgResult cg = conjugateGradients(problem_->pattern(), at.hessian, cholesky_, -at.residual, wanted, limit, d);
  result.inner_iterations += cg.iterations;
  if (!cg.converged || !d.allFinite()) {
    patience_ = OLD_FACTOR_PAUSE;
    return false;
  }
  patience_ = 0;
  ++result.iterations;
  return true;
}

Eigen::VectorXd Newton::turnedSolve(const Eigen::VectorXd& b) const {
  Eigen::VectorXd x = b;
  turn(turns_, true, x);
  x = cholesky_.solve(x);
  turn(turns_, false, x);
  return x;
}

/// The turned factor, corrected by what the steps since have shown: limited-memory BFGS [Nocedal 1980] with that factor
/// as its first matrix. Downhill, since both are positive definite.
Eigen::VectorXd Newton::alongFactor(const Eigen::VectorXd& residual) const {
  Eigen::VectorXd q = residual;
  std::vector<double> share(secants_.size());
  for (std::size_t k = secants_.size(); k-- > 0;) {
    share[k] = secants_[k].step.dot(q) / secants_[k].product;
    q -= share[k] * secants_[k].change;
  }
  Eigen::VectorXd d = turnedSolve(q);
  for (std::size_t k = 0; k < secants_.size(); ++k) {
    d += (share[k] - secants_[k].change.dot(d) / secants_[k].product) * secants_[k].step;
  }
  return -d;
}

void Newton::learn(const Eigen::VectorXd& step, const Eigen::VectorXd& change) {
  const double product = step.dot(change);
  if (!(product > 1e-12 * step.norm() * change.norm())) return;  // BFGS stays positive definite
  if (secants_.size() == MOST_SECANTS) secants_.erase(secants_.begin());
  secants_.push_back({step, change, product});
}

bool Newton::direction(const Eigen::VectorXd& z, const Held& held, Evaluation& at, Eigen::VectorXd& d,
                       NewtonResult& result) {
  if (along_) {
    d = alongFactor(at.residual);
    ++result.iterations;
    return d.allFinite();
  }
  if (settings_.keep_factor) {
    evaluate(z, held, Order::TANGENT, at);
    factor_rotations_ = problem_->nodeRotations(at);
    turns_.clear();
    secants_.clear();
  } else if (nearby(at, d, result)) {
    return true;
  }
  bool good = false;
  if (settings_.projection == Projection::ON_DEMAND) {
    ++result.factorizations;
    good = cholesky_.factorize(at.hessian);
    factor_is_recent_ = good;
    // Where no energy decides, the residual must fall, which a projected tangent's step need not do (saddleDirection).
    if (!good && !at.potential) {
      ++result.factorizations;
      good = cholesky_.factorizeIndefinite(at.hessian) >= 0;
    }
  }
  if (!good) {
    factor_is_recent_ = false;
    evaluate(z, held, projectedOrder(settings_.projection), trial_);
    ++result.projections;
    std::vector<double>& hessian = trial_.hessian;
    double largest = 0;
    const SparsePattern& pattern = problem_->pattern();
    for (int c = 0; c < pattern.size; ++c) largest = std::max(largest, std::abs(hessian[pattern.start[c]]));
    // A projected Hessian may still be singular to rounding: a small shift then stands in for what is missing.
    for (const double shift : {0.0, 1e-10, 1e-6, 1e-3}) {
      if (shift > 0) {
        for (int c = 0; c < pattern.size; ++c) hessian[pattern.start[c]] += shift * largest;
      }
      ++result.factorizations;
      if ((good = cholesky_.factorize(hessian))) break;
    }
  }
  if (!good) return false;
  d = -cholesky_.solve(at.residual);
  ++result.iterations;
  return d.allFinite();
}

bool Newton::lineSearch(const Eigen::VectorXd& p, const Eigen::VectorXd& multipliers, const Eigen::VectorXd& d,
                        Eigen::VectorXd& z, Evaluation& at) {
  const Held held{p, multipliers};
  const double slope = at.residual.dot(d);
  // Near the solution differences of the energy are rounding; slopes of it are not, and decide there instead
  // (approximate Wolfe conditions, Hager and Zhang 2005).
  const double rounding = std::max(1e-10 * (std::abs(at.elastic_energy) + std::abs(at.energy - at.elastic_energy)),
                                   problem_->energyFloor());
  double length = 1;
  for (int trial = 0; trial < 40; ++trial, length *= 0.5) {
    const Eigen::VectorXd candidate = z + length * d;
    evaluate(candidate, held, trial == 0 && !settings_.keep_factor ? Order::TANGENT : Order::STRESS, trial_);
    if (!trial_.finite) continue;
    const bool lower = at.potential ? trial_.energy <= at.energy + 1e-4 * length * slope
                                    : trial_.residual.norm() <= (1 - 1e-4 * length) * at.residual.norm();
    const double slope_there = trial_.residual.dot(d);
    const bool flatter = at.potential && trial_.energy <= at.energy + rounding && slope_there >= 0.9 * slope &&
                         slope_there <= -0.998 * slope;
    if (!lower && !flatter) continue;
    if (trial > 0 && !settings_.keep_factor) evaluate(candidate, held, Order::TANGENT, trial_);
    z = candidate;
    std::swap(at, trial_);
    return true;
  }
  return false;
}

NewtonResult Newton::solve(const Eigen::VectorXd& p, Eigen::VectorXd& z, Evaluation& at,
                           const Eigen::VectorXd& multipliers) {
  if (problem_->constraints() != nullptr && multipliers.size() != problem_->constraints()->count()) {
    throw common::Error("Newton's method has " + std::to_string(multipliers.size()) + " multipliers for " +
                        std::to_string(problem_->constraints()->count()) +
                        " constraints; allowed: as many, or EquilibriumSolver, which finds them");
  }
  const Held held{p, multipliers};
  NewtonResult result;
  const auto finish = [&](SolveStatus status, const std::string& message) {
    result.status = status;
    result.message = message;
    return result;
  };
  evaluate(z, held, settings_.keep_factor ? Order::STRESS : Order::TANGENT, at);
  if (!at.finite) {
    std::ostringstream text;
    text << "det F = " << at.min_det_f << " in " << problem_->describeCell(at.min_det_f_cell);
    return finish(SolveStatus::INVERTED_START, text.str());
  }
  Eigen::VectorXd d;
  factor_is_recent_ = false;
  secants_.clear();
  if (settings_.keep_factor && cholesky_.definite()) {
    turns_ = turnsBetween(factor_rotations_, problem_->nodeRotations(at));
  }
  for (int iteration = 0;; ++iteration) {
    const double before = result.residual;
    result.residual = at.residual.norm();
    // An old factor is for the last digits of a solution that is near, not for the way there, nor for rounding.
    old_factor_serves_ = iteration == 0 || result.residual < 0.1 * before;
    along_ = settings_.keep_factor && cholesky_.definite() &&
             (iteration == 0 || result.residual < KEPT_FACTOR_SERVES * before);
    if (result.residual <= tolerance(at)) return finish(SolveStatus::CONVERGED, "");
    if (iteration == settings_.max_iterations) break;
    if (settings_.cancelled && settings_.cancelled()) return finish(SolveStatus::CANCELLED, "cancelled");
    if (!direction(z, held, at, d, result)) {
      return finish(SolveStatus::SINGULAR,
                    "the Hessian has no Cholesky factor even when projected: is every body supported?");
    }
    Eigen::VectorXd z_before, residual_before;
    if (settings_.keep_factor) z_before = z, residual_before = at.residual;
    const bool stepped = lineSearch(p, multipliers, d, z, at);
    if (stepped && settings_.keep_factor) learn(z - z_before, at.residual - residual_before);
    if (!stepped) {
      if (along_) {  // the factor of another point may point uphill
        cholesky_.drop();
        continue;
      }
      std::ostringstream text;
      text << "no shorter step lowers the energy; |r| = " << result.residual << " N, smallest det F = " << at.min_det_f
           << " in " << problem_->describeCell(at.min_det_f_cell);
      return finish(SolveStatus::LINE_SEARCH_FAILED, text.str());
    }
  }
  std::ostringstream text;
  text << "|r| = " << result.residual << " N after " << result.iterations << " iterations, wanted " << tolerance(at);
  return finish(SolveStatus::ITERATION_LIMIT, text.str());
}

}  // namespace snapwing::solver
