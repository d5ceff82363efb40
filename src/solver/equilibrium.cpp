#include "snapwing/solver/equilibrium.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "conjugate_gradients.h"
#include "snapwing/common/error.h"
#include "unsymmetric_vector.h"

namespace snapwing::solver {

namespace {

constexpr int CORRECTOR_ITERATIONS = 15;
constexpr int OUTER_ITERATIONS = 40;

NewtonResult finish(NewtonResult result, SolveStatus status, const std::string& message) {
  result.status = status;
  result.message = message;
  return result;
}

NewtonResult inverted(const Problem& problem, const Evaluation& at, NewtonResult result) {
  std::ostringstream text;
  text << "det F = " << at.min_det_f << " in " << problem.describeCell(at.min_det_f_cell);
  return finish(std::move(result), SolveStatus::INVERTED_START, text.str());
}

NewtonResult exhausted(double residual, NewtonResult result) {
  std::ostringstream text;
  text << "|r| = " << residual << " N after " << result.iterations << " iterations";
  return finish(std::move(result), SolveStatus::ITERATION_LIMIT, text.str());
}

/// Stiff pieces that turn far are steered by their own compression, which projection takes away: near a dead point of a
/// mechanism the exact tangent with a little of the unit matrix needs half the iterations.
bool factorizeShifted(TangentSystem& system, const SparsePattern& pattern, const Evaluation& at, NewtonResult& result) {
  std::vector<double> hessian = at.hessian;
  double largest = 0;
  for (int c = 0; c < pattern.size; ++c) largest = std::max(largest, std::abs(hessian[pattern.start[c]]));
  double before = 0;
  for (double shift = 1e-6 * largest; shift < largest; shift *= 10) {
    for (int c = 0; c < pattern.size; ++c) hessian[pattern.start[c]] += shift - before;
    before = shift;
    ++result.factorizations;
    if (system.factorizeDefinite(hessian, at.rows)) return true;
  }
  return false;
}

}  // namespace

EquilibriumSolver::EquilibriumSolver(const Problem& problem, const NewtonSettings& settings, ControlLine line)
    : problem_(problem),
      settings_(settings),
      constraints_(problem.constraints()),
      newton_(problem, settings),
      system_(problem, newton_.cholesky()) {
  setLine(std::move(line));
}

void EquilibriumSolver::setLine(ControlLine line) {
  const Eigen::Index count = problem_->controlCount();
  one_control_ = count == 1 && line.direction.size() == 0;
  if (!one_control_ && (line.start.size() != count || line.direction.size() != count)) {
    throw common::Error("the line of controls has " + std::to_string(line.start.size()) + " and " +
                        std::to_string(line.direction.size()) + " values in start and direction; allowed: " +
                        std::to_string(count) + ", as the problem has controls");
  }
  line_ = std::move(line);
}

Eigen::VectorXd EquilibriumSolver::controls(double t) const {
  if (one_control_) return Eigen::VectorXd::Constant(1, t);
  return line_.start + t * line_.direction;
}

/// dp/dt
Eigen::VectorXd EquilibriumSolver::driven() const { return one_control_ ? Eigen::VectorXd::Ones(1) : line_.direction; }

/// The force on t in the place of those on each control. A problem without controls may leave what was here before.
void EquilibriumSolver::alongLine(Evaluation& at) const {
  if (one_control_) return;
  const bool driven = line_.direction.size() > 0 && at.control_force.size() == line_.direction.size();
  const double force = driven ? line_.direction.dot(at.control_force) : 0;
  at.control_force = Eigen::VectorXd::Constant(1, force);
}

Equilibrium EquilibriumSolver::start(const Eigen::VectorXd& z, double p) const {
  Equilibrium x;
  x.p(0) = p;
  x.z = z;
  x.multipliers = Eigen::VectorXd::Zero(constraintCount());
  return x;
}

void EquilibriumSolver::evaluate(const Equilibrium& x, Order order, Evaluation& at) {
  const double begin = secondsNow();
  if (constraints_ != nullptr) {
    problem_->evaluateLagrangian(x.z, controls(x.p(0)), x.multipliers, order, at);
  } else {
    problem_->evaluate(x.z, controls(x.p(0)), order, at);
  }
  if (order != Order::ENERGY) alongLine(at);
  seconds_assembly_ += secondsNow() - begin;
}

bool EquilibriumSolver::closed(const Equilibrium& x) const {
  return constraints_ == nullptr || x.at.constraint_residual.cwiseAbs().maxCoeff() <= constraints_->tolerance();
}

bool EquilibriumSolver::balanced(const Equilibrium& x) const {
  return x.at.residual.norm() <= residualTolerance(*problem_, x.at, settings_) && closed(x);
}

NewtonResult EquilibriumSolver::minimise(Equilibrium& x) {
  if (constraints_ != nullptr) return constraints_->enforcement() == Enforcement::MULTIPLIERS ? saddle(x) : augment(x);
  const NewtonResult result = newton_.solve(controls(x.p(0)), x.z, x.at);
  alongLine(x.at);
  return result;
}

/// Bodies that turn are held by what their constraints bear: without it the first Hessian lacks the stiffness of all
/// that hangs. Where nothing is known of the multipliers they are those that leave the smallest residual.
void EquilibriumSolver::estimateMultipliers(Equilibrium& x) {
  if (!problem_->curvedConstraints() || !x.multipliers.isZero(0)) return;
  constexpr double ROUNDING = 1e-12;
  evaluate(x, Order::TANGENT, x.at);
  if (!x.at.finite) return;
  // Without the penalty's force: open constraints say nothing of what holds them.
  const Eigen::VectorXd force =
      x.at.residual - x.at.rows->transpose() * (constraints_->penalty() * x.at.constraint_residual);
  const ConstraintRows across = x.at.rows->transpose();
  Eigen::MatrixXd gram(*x.at.rows * across);
  gram.diagonal().array() += ROUNDING * gram.diagonal().maxCoeff();
  x.multipliers = -gram.ldlt().solve(*x.at.rows * force);
  if (!x.multipliers.allFinite()) x.multipliers.setZero();
}

/// The paper's way: minimise L at fixed multipliers, then lambda += rho g.
NewtonResult EquilibriumSolver::augment(Equilibrium& x) {
  NewtonResult total;
  estimateMultipliers(x);
  const int most = std::max(OUTER_ITERATIONS, settings_.max_iterations);
  for (int outer = 0; outer < most; ++outer) {
    const NewtonResult inner = newton_.solve(controls(x.p(0)), x.z, x.at, x.multipliers);
    alongLine(x.at);
    total.iterations += inner.iterations;
    total.factorizations += inner.factorizations;
    total.projections += inner.projections;
    total.residual = inner.residual;
    if (!inner.converged()) return finish(total, inner.status, inner.message);
    if (closed(x)) return finish(total, SolveStatus::CONVERGED, "");
    x.multipliers += constraints_->penalty() * x.at.constraint_residual;
  }
  std::ostringstream text;
  text << "the constraint residual of ports and joints is " << x.at.constraint_residual.cwiseAbs().maxCoeff()
       << " m after " << most << " updates of the multipliers";
  return finish(total, SolveStatus::ITERATION_LIMIT, text.str());
}

bool EquilibriumSolver::saddleDirection(const Equilibrium& x, NewtonResult& result, Eigen::VectorXd& dz,
                                        Eigen::VectorXd& dl) {
  bool good = false;
  if (settings_.projection == Projection::ON_DEMAND) {
    ++result.factorizations;
    good = system_.factorizeDefinite(x.at.hessian, x.at.rows);
    if (!good && problem_->energyFloor() > 0) {
      good = factorizeShifted(system_, problem_->pattern(), x.at, result);
    }
    // Where no energy decides, the residual must fall, also on the way to a saddle of the energy. Newton's own step
    // lowers it whatever the inertia; that of a projected tangent leads away from saddles and raises it.
    if (!good && !x.at.potential) {
      ++result.factorizations;
      good = system_.factorize(x.at) >= 0;
    }
  }
  if (!good) {
    evaluate(x, projectedOrder(settings_.projection), trial_);
    ++result.projections;
    ++result.factorizations;
    good = system_.factorizeDefinite(trial_.hessian, trial_.rows) ||
           factorizeShifted(system_, problem_->pattern(), trial_, result);
  }
  if (!good) return false;
  system_.solve(-x.at.residual, -x.at.constraint_residual, dz, dl);
  ++result.iterations;
  return dz.allFinite() && dl.allFinite();
}

/// With closed constraints whose rows are constant a step keeps them closed, and the energy decides on its length as
/// without. Open ones are closed first, by the longest step that inverts no element.
bool EquilibriumSolver::saddleStep(const Eigen::VectorXd& dz, const Eigen::VectorXd& dl, Equilibrium& x) {
  if (problem_->curvedConstraints()) return curvedStep(dz, dl, x);
  if (closed(x)) {
    if (!newton_.lineSearch(controls(x.p(0)), x.multipliers, dz, x.z, x.at)) return false;
    alongLine(x.at);
    // The multipliers enter linearly.
    x.multipliers += dl;
    x.at.residual += x.at.rows->transpose() * dl;
    x.at.control_force(0) -= (constraints_->control() * driven()).dot(dl);
    return true;
  }
  Equilibrium moved = x;
  moved.multipliers += dl;
  for (double length = 1; length > 1e-6; length *= 0.5) {
    moved.z = x.z + length * dz;
    evaluate(moved, Order::TANGENT, moved.at);
    if (!moved.at.finite) continue;
    x = std::move(moved);
    return true;
  }
  return false;
}

/// Rows that change on the way: H dz = -(r + A^T dl) is Newton's step for L at the new multipliers, which decides on
/// its length, whether the constraints are open or closed.
bool EquilibriumSolver::curvedStep(const Eigen::VectorXd& dz, const Eigen::VectorXd& dl, Equilibrium& x) {
  Equilibrium moved = x;
  moved.multipliers += dl;
  evaluate(moved, Order::STRESS, moved.at);
  if (!newton_.lineSearch(controls(x.p(0)), moved.multipliers, dz, moved.z, moved.at)) return false;
  alongLine(moved.at);
  x = std::move(moved);
  return true;
}

NewtonResult EquilibriumSolver::saddle(Equilibrium& x) {
  NewtonResult result;
  estimateMultipliers(x);
  evaluate(x, Order::TANGENT, x.at);
  if (!x.at.finite) return inverted(*problem_, x.at, result);
  Eigen::VectorXd dz, dl;
  for (int iteration = 0;; ++iteration) {
    result.residual = x.at.residual.norm();
    if (balanced(x)) {
      // Steps update residual and forces for the multipliers; what leaves here does not depend on how it was reached.
      evaluate(x, Order::TANGENT, x.at);
      if (balanced(x)) return finish(result, SolveStatus::CONVERGED, "");
    }
    if (iteration == settings_.max_iterations) return exhausted(result.residual, result);
    if (settings_.cancelled && settings_.cancelled()) return finish(result, SolveStatus::CANCELLED, "cancelled");
    if (!saddleDirection(x, result, dz, dl)) {
      const std::string dead = system_.deadPoint();
      return finish(result, SolveStatus::SINGULAR,
                    !dead.empty() ? dead
                                  : "the saddle point's matrix is singular even when projected: is every body "
                                    "supported?");
    }
    if (!saddleStep(dz, dl, x)) {
      std::ostringstream text;
      text << "no shorter step lowers the energy; |r| = " << result.residual
           << " N, smallest det F = " << x.at.min_det_f << " in " << problem_->describeCell(x.at.min_det_f_cell);
      return finish(result, SolveStatus::LINE_SEARCH_FAILED, text.str());
    }
  }
}

NewtonResult EquilibriumSolver::correct(Equilibrium& x) {
  BranchPlane fixed;
  fixed.origin = x.z;
  fixed.normal = Eigen::VectorXd::Zero(x.z.size());
  fixed.control = x.p(0);
  fixed.control_normal = 1;
  return correctOn(fixed, x);
}

NewtonResult EquilibriumSolver::correctOn(const BranchPlane& plane, Equilibrium& x) {
  NewtonResult result;
  Eigen::VectorXd a, a_multipliers;
  for (int iteration = 0; iteration <= CORRECTOR_ITERATIONS; ++iteration) {
    evaluate(x, Order::TANGENT, x.at);
    if (!x.at.finite) return inverted(*problem_, x.at, result);
    result.residual = x.at.residual.norm();
    const double gap_on_plane =
        plane.distance - plane.normal.dot(x.z - plane.origin) - plane.control_normal * (x.p(0) - plane.control);
    result.factorizations += linearise(x);
    if (x.negative_pivots < 0) {
      const std::string dead = system_.deadPoint();
      return finish(result, SolveStatus::SINGULAR, dead.empty() ? "the Hessian is singular to rounding" : dead);
    }
    // Where the corrector starts on the plane it stays there, but for rounding.
    if (balanced(x) && (iteration > 0 || std::abs(gap_on_plane) <= 1e-9 * std::abs(plane.distance) + 1e-300)) {
      return finish(result, SolveStatus::CONVERGED, "");
    }
    if (iteration == CORRECTOR_ITERATIONS) break;
    if (settings_.cancelled && settings_.cancelled()) return finish(result, SolveStatus::CANCELLED, "cancelled");
    ++result.iterations;
    system_.solve(-x.at.residual, constraints_ ? Eigen::VectorXd(-x.at.constraint_residual) : Eigen::VectorXd(), a,
                  a_multipliers);
    const double dp = (gap_on_plane - plane.normal.dot(a)) / (plane.normal.dot(x.slope) + plane.control_normal);
    if (!std::isfinite(dp) || !a.allFinite()) break;
    x.z += a + dp * x.slope;
    x.p(0) += dp;
    if (constraints_ != nullptr) x.multipliers += a_multipliers + dp * x.multiplier_slope;
  }
  return exhausted(result.residual, result);
}

int EquilibriumSolver::restart(Equilibrium& x) {
  newton_.forget();
  probe_.resize(0);
  return linearise(x);
}

void EquilibriumSolver::restart() {
  newton_.restart();
  probe_.resize(0);
}

int EquilibriumSolver::linearise(Equilibrium& x) {
  Eigen::VectorXd control_part;
  const Eigen::VectorXd along = driven();
  problem_->controlTangent(x.at, along, x.load, control_part);
  x.control_curvature = along.dot(control_part);
  x.negative_pivots = system_.factorize(x.at);
  x.slope = Eigen::VectorXd::Zero(x.z.size());
  x.multiplier_slope = Eigen::VectorXd::Zero(constraintCount());
  const Eigen::VectorXd moved = constraints_ ? Eigen::VectorXd(constraints_->control() * along) : Eigen::VectorXd();
  if (x.negative_pivots >= 0) {
    Eigen::VectorXd slope, multiplier_slope;
    system_.solve(-x.load, moved, slope, multiplier_slope);
    if (slope.allFinite() && multiplier_slope.allFinite()) {
      x.slope = slope;
      x.multiplier_slope = multiplier_slope;
    }
  }
  x.stiffness = x.control_curvature + x.load.dot(x.slope);
  if (constraints_ != nullptr) x.stiffness -= moved.dot(x.multiplier_slope);
  return 1;
}

/// A motion w with some of every motion in it, the soft ones above all: F^-1 of a load without symmetry. It serves
/// while the Hessian makes no much larger load of it. @param load  H w
void EquilibriumSolver::findProbe(const Equilibrium& x, Eigen::VectorXd& load) {
  constexpr double STILL_SOFT = 4;
  const SparsePattern& pattern = problem_->pattern();
  if (probe_.size() > 0) {
    load = pattern.multiply(x.at.hessian, probe_);
    if (load.norm() <= STILL_SOFT * probe_push_) return;
  }
  const Eigen::VectorXd push = unsymmetricVector(x.z.size());
  probe_push_ = push.norm();
  probe_ = newton_.cholesky().solve(push);
  load = pattern.multiply(x.at.hessian, probe_);
}

int EquilibriumSolver::lineariseNear(Equilibrium& x, const Eigen::VectorXd& guess) {
  constexpr double ACCURACY = 1e-12, SHARE = 1e-2;
  const Cholesky& cholesky = newton_.cholesky();
  if (constraints_ != nullptr || !cholesky.definite()) return linearise(x);
  Eigen::VectorXd control_part, probe_load;
  const Eigen::VectorXd along = driven();
  problem_->controlTangent(x.at, along, x.load, control_part);
  findProbe(x, probe_load);
  // Solved for the slope plus a hundredth of the probe, from a guess of the slope alone: the first residual has the
  // probe's load, and what converges then shows that no motion is unstable (see conjugate_gradients.h). Its share is
  // large enough for eigenvalues down to -1e-8 or so to be met.
  const double share = SHARE * x.load.norm() / probe_load.norm();
  x.slope = guess;
  const CgResult cg =
      conjugateGradients(problem_->pattern(), x.at.hessian, cholesky, share * probe_load - x.load,
                         ACCURACY * x.load.norm(), static_cast<int>(cholesky.factorCostInSolves()), x.slope);
  if (!cg.converged) return linearise(x);
  x.slope -= share * probe_;
  x.multiplier_slope.resize(0);
  x.control_curvature = along.dot(control_part);
  x.negative_pivots = 0;
  x.stiffness = x.control_curvature + x.load.dot(x.slope);
  return 0;
}

bool EquilibriumSolver::recall(const Eigen::VectorXd& slope, int negative_pivots, Equilibrium& x) {
  if (constraints_ != nullptr) return false;
  evaluate(x, Order::TANGENT, x.at);
  if (!x.at.finite || !balanced(x)) return false;
  Eigen::VectorXd control_part;
  const Eigen::VectorXd along = driven();
  problem_->controlTangent(x.at, along, x.load, control_part);
  x.control_curvature = along.dot(control_part);
  x.slope = slope;
  x.multiplier_slope.resize(0);
  x.negative_pivots = negative_pivots;
  x.stiffness = x.control_curvature + x.load.dot(slope);
  return true;
}

double EquilibriumSolver::imbalance(const Equilibrium& x) const {
  if (!x.at.finite) return std::numeric_limits<double>::infinity();
  return x.at.residual.norm() / residualTolerance(*problem_, x.at, settings_);
}

bool EquilibriumSolver::settle(const Eigen::VectorXd& slope, Equilibrium& x) {
  if (!recall(slope, 0, x)) return false;
  // The least of a quadratic form: an error of the slope enters squared.
  x.stiffness += x.load.dot(slope) + slope.dot(problem_->pattern().multiply(x.at.hessian, slope));
  return true;
}

Equilibrium EquilibriumSolver::predict(const Equilibrium& from, double p) const {
  Equilibrium x;
  x.p(0) = p;
  const double step = p - from.p(0);
  x.z = from.z + step * from.slope;
  x.multipliers = constraints_ != nullptr ? from.multipliers + step * from.multiplier_slope : Eigen::VectorXd();
  return x;
}

double EquilibriumSolver::softestMode(const Equilibrium& x, Eigen::VectorXd& mode, int iterations) const {
  const Eigen::VectorXd closed = Eigen::VectorXd::Zero(constraintCount());
  mode = unsymmetricVector(x.z.size());
  Eigen::VectorXd next, multipliers;
  double inverse = 0;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    mode.normalize();
    system_.solve(mode, closed, next, multipliers);
    inverse = mode.dot(next);
    const double turned = next.norm() - std::abs(inverse);
    mode = next;
    if (iteration > 1 && std::abs(turned) < 1e-10 * std::abs(inverse)) break;
  }
  mode.normalize();
  return 1 / inverse;
}

bool EquilibriumSolver::supported(const Equilibrium& x) const {
  constexpr double ROUNDING = 2e-15;
  if (x.negative_pivots < 0) return false;
  if (x.z.size() == 0) return true;
  Eigen::VectorXd mode;
  softestMode(x, mode, 4);
  if (!mode.allFinite()) return false;
  // The energy of the motion against the terms that cancel in it where nothing resists.
  const SparsePattern& pattern = problem_->pattern();
  double terms = 0;
  for (int c = 0; c < pattern.size; ++c) terms += std::abs(x.at.hessian[pattern.start[c]]) * mode(c) * mode(c);
  return std::abs(mode.dot(pattern.multiply(x.at.hessian, mode))) > ROUNDING * terms;
}

}  // namespace snapwing::solver
