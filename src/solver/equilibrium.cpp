#include "snapwing/solver/equilibrium.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "snapwing/solver/conjugate_gradients.h"

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
bool factorizeShifted(TangentSystem& system, const SparsePattern& pattern, std::vector<double> hessian,
                      NewtonResult& result) {
  double largest = 0;
  for (int c = 0; c < pattern.size; ++c) largest = std::max(largest, std::abs(hessian[pattern.start[c]]));
  double before = 0;
  for (double shift = 1e-6 * largest; shift < largest; shift *= 10) {
    for (int c = 0; c < pattern.size; ++c) hessian[pattern.start[c]] += shift - before;
    before = shift;
    ++result.factorizations;
    if (system.factorizeDefinite(hessian)) return true;
  }
  return false;
}

}  // namespace

bool TangentSystem::factorizeDefinite(const std::vector<double>& hessian) {
  return cholesky_.factorize(hessian) && formSchur() == 0;
}

int TangentSystem::factorize(const std::vector<double>& hessian) {
  if (cholesky_.factorize(hessian)) return formSchur() == 0 ? 0 : -1;
  const int negative = cholesky_.factorizeIndefinite(hessian);
  if (negative < 0) return -1;
  const int of_ties = formSchur();
  return of_ties < 0 || of_ties > negative ? -1 : negative - of_ties;
}

/// @return negative eigenvalues of S, -1 if it is singular
int TangentSystem::formSchur() {
  if (problem_.tied() == nullptr) return 0;
  const auto& rows = problem_.tied()->ties().rows;
  spread_ = cholesky_.solve(Eigen::MatrixXd(rows.transpose()));
  const Eigen::MatrixXd schur = rows * spread_;
  if (!schur.allFinite()) return -1;
  schur_.compute(0.5 * (schur + schur.transpose()));
  const Eigen::VectorXd& values = schur_.eigenvalues();
  if (values.size() > 0 && values.cwiseAbs().minCoeff() < 1e-14 * values.cwiseAbs().maxCoeff()) return -1;
  return static_cast<int>((values.array() < 0).count());
}

template <class Dense>
void TangentSystem::solveAny(const Dense& f, const Dense& g, Dense& z, Dense& lambda) const {
  z = cholesky_.solve(f);
  lambda.resize(0, f.cols());
  if (problem_.tied() == nullptr) return;
  const Dense gap = problem_.tied()->ties().rows * z - g;
  const Eigen::MatrixXd& basis = schur_.eigenvectors();
  Dense shares = basis.transpose() * gap;
  shares.array().colwise() /= schur_.eigenvalues().array();
  lambda = basis * shares;
  z -= spread_ * lambda;
}

void TangentSystem::solve(const Eigen::VectorXd& f, const Eigen::VectorXd& g, Eigen::VectorXd& z,
                          Eigen::VectorXd& lambda) const {
  solveAny(f, g, z, lambda);
}

void TangentSystem::solve(const Eigen::MatrixXd& f, const Eigen::MatrixXd& g, Eigen::MatrixXd& z,
                          Eigen::MatrixXd& lambda) const {
  solveAny(f, g, z, lambda);
}

EquilibriumSolver::EquilibriumSolver(const Problem& problem, const NewtonSettings& settings)
    : problem_(problem),
      settings_(settings),
      tied_(problem.tied() ? std::make_unique<TiedProblem>(*problem.tied()) : nullptr),
      newton_(this->problem(), settings),
      system_(this->problem(), newton_.cholesky()) {}

Equilibrium EquilibriumSolver::start(const Eigen::VectorXd& z, double p) const {
  Equilibrium x;
  x.p(0) = p;
  x.z = z;
  x.multipliers = Eigen::VectorXd::Zero(tieCount());
  return x;
}

void EquilibriumSolver::evaluate(const Equilibrium& x, Order order, Evaluation& at) {
  const double begin = secondsNow();
  if (tied_) tied_->setMultipliers(x.multipliers);
  problem().evaluate(x.z, x.p, order, at);
  seconds_assembly_ += secondsNow() - begin;
}

Eigen::VectorXd EquilibriumSolver::gap(const Equilibrium& x) const {
  return tied_ ? tied_->gap(x.z, x.p) : Eigen::VectorXd();
}

bool EquilibriumSolver::balanced(const Equilibrium& x) const {
  const double allowed = std::max(settings_.relative_tolerance * x.at.force_scale, problem_.forceFloor());
  if (x.at.residual.norm() > allowed) return false;
  return tieCount() == 0 || gap(x).cwiseAbs().maxCoeff() <= tied_->gapTolerance();
}

NewtonResult EquilibriumSolver::minimise(Equilibrium& x) {
  if (tieCount() == 0) return newton_.solve(x.p, x.z, x.at);
  return tied_->drive() == Drive::MULTIPLIERS ? saddle(x) : augment(x);
}

/// The paper's way: minimise L at fixed multipliers, then lambda += rho g.
NewtonResult EquilibriumSolver::augment(Equilibrium& x) {
  NewtonResult total;
  const int most = std::max(OUTER_ITERATIONS, settings_.max_iterations);
  for (int outer = 0; outer < most; ++outer) {
    tied_->setMultipliers(x.multipliers);
    const NewtonResult inner = newton_.solve(x.p, x.z, x.at);
    total.iterations += inner.iterations;
    total.factorizations += inner.factorizations;
    total.projections += inner.projections;
    total.residual = inner.residual;
    if (!inner.converged()) return finish(total, inner.status, inner.message);
    const Eigen::VectorXd open = gap(x);
    if (open.cwiseAbs().maxCoeff() <= tied_->gapTolerance()) return finish(total, SolveStatus::CONVERGED, "");
    x.multipliers += tied_->penalty() * open;
  }
  std::ostringstream text;
  text << "ports and joints gape by " << gap(x).cwiseAbs().maxCoeff() << " m after " << most
       << " updates of the multipliers";
  return finish(total, SolveStatus::ITERATION_LIMIT, text.str());
}

bool EquilibriumSolver::saddleDirection(const Equilibrium& x, NewtonResult& result, Eigen::VectorXd& dz,
                                        Eigen::VectorXd& dl) {
  bool good = false;
  if (settings_.projection == Projection::ON_DEMAND) {
    ++result.factorizations;
    good = system_.factorizeDefinite(x.at.hessian);
    if (!good && problem().energyFloor() > 0) {
      good = factorizeShifted(system_, problem().pattern(), x.at.hessian, result);
    }
  }
  if (!good) {
    evaluate(x, projectedOrder(settings_.projection), trial_);
    ++result.projections;
    ++result.factorizations;
    good = system_.factorizeDefinite(trial_.hessian);
  }
  if (!good) return false;
  system_.solve(-x.at.residual, -gap(x), dz, dl);
  ++result.iterations;
  return dz.allFinite() && dl.allFinite();
}

/// With closed ties a step keeps them closed, and the energy decides on its length as without ties. Open ties are
/// closed first, by the longest step that turns nothing inside out.
bool EquilibriumSolver::saddleStep(const Eigen::VectorXd& dz, const Eigen::VectorXd& dl, Equilibrium& x) {
  tied_->setMultipliers(x.multipliers);
  if (gap(x).cwiseAbs().maxCoeff() <= tied_->gapTolerance()) {
    if (!newton_.lineSearch(x.p, dz, x.z, x.at)) return false;
    // The multipliers enter linearly.
    x.multipliers += dl;
    x.at.residual += tied_->ties().rows.transpose() * dl;
    x.at.control_force -= tied_->ties().control.transpose() * dl;
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

NewtonResult EquilibriumSolver::saddle(Equilibrium& x) {
  NewtonResult result;
  evaluate(x, Order::TANGENT, x.at);
  if (!x.at.finite) return inverted(problem(), x.at, result);
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
      return finish(result, SolveStatus::SINGULAR,
                    "the saddle point's matrix is singular even when projected: is every body supported?");
    }
    if (!saddleStep(dz, dl, x)) {
      std::ostringstream text;
      text << "no shorter step lowers the energy; |r| = " << result.residual
           << " N, smallest det F = " << x.at.min_det_f << " in " << problem().describeCell(x.at.min_det_f_cell);
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
    if (!x.at.finite) return inverted(problem(), x.at, result);
    result.residual = x.at.residual.norm();
    const double gap_on_plane =
        plane.distance - plane.normal.dot(x.z - plane.origin) - plane.control_normal * (x.p(0) - plane.control);
    result.factorizations += settle(x);
    if (x.negative_pivots < 0) {
      return finish(result, SolveStatus::SINGULAR, "the Hessian is singular to rounding");
    }
    // Where the corrector starts on the plane it stays there, but for rounding.
    if (balanced(x) && (iteration > 0 || std::abs(gap_on_plane) <= 1e-9 * std::abs(plane.distance) + 1e-300)) {
      return finish(result, SolveStatus::CONVERGED, "");
    }
    if (iteration == CORRECTOR_ITERATIONS) break;
    if (settings_.cancelled && settings_.cancelled()) return finish(result, SolveStatus::CANCELLED, "cancelled");
    ++result.iterations;
    system_.solve(-x.at.residual, -gap(x), a, a_multipliers);
    const double dp = (gap_on_plane - plane.normal.dot(a)) / (plane.normal.dot(x.slope) + plane.control_normal);
    if (!std::isfinite(dp) || !a.allFinite()) break;
    x.z += a + dp * x.slope;
    x.p(0) += dp;
    if (tieCount() > 0) x.multipliers += a_multipliers + dp * x.multiplier_slope;
  }
  return exhausted(result.residual, result);
}

int EquilibriumSolver::settle(Equilibrium& x) {
  Eigen::VectorXd control_part;
  problem().controlTangent(x.at, Eigen::VectorXd::Ones(1), x.load, control_part);
  x.control_curvature = control_part(0);
  x.negative_pivots = system_.factorize(x.at.hessian);
  x.slope = Eigen::VectorXd::Zero(x.z.size());
  x.multiplier_slope = Eigen::VectorXd::Zero(tieCount());
  if (x.negative_pivots >= 0) {
    Eigen::VectorXd slope, multiplier_slope;
    const Eigen::VectorXd driven = tied_ ? Eigen::VectorXd(tied_->ties().control.col(0)) : Eigen::VectorXd();
    system_.solve(-x.load, driven, slope, multiplier_slope);
    if (slope.allFinite() && multiplier_slope.allFinite()) {
      x.slope = slope;
      x.multiplier_slope = multiplier_slope;
    }
  }
  x.stiffness = x.control_curvature + x.load.dot(x.slope);
  if (tieCount() > 0) x.stiffness -= tied_->ties().control.col(0).dot(x.multiplier_slope);
  return 1;
}

int EquilibriumSolver::settleNear(Equilibrium& x) {
  constexpr double NEAR = 1e-2;
  const Cholesky& cholesky = newton_.cholesky();
  if (tieCount() > 0 || !(cholesky.distance(x.at.hessian) < NEAR)) return settle(x);
  Eigen::VectorXd control_part;
  problem().controlTangent(x.at, Eigen::VectorXd::Ones(1), x.load, control_part);
  const CgResult cg =
      conjugateGradients(problem().pattern(), x.at.hessian, cholesky, -x.load, 1e-10 * x.load.norm(), 12, x.slope);
  if (!cg.converged) return settle(x);
  x.multiplier_slope.resize(0);
  x.control_curvature = control_part(0);
  x.negative_pivots = 0;
  x.stiffness = x.control_curvature + x.load.dot(x.slope);
  return 0;
}

Equilibrium EquilibriumSolver::predict(const Equilibrium& from, double p) const {
  Equilibrium x;
  x.p(0) = p;
  const double step = p - from.p(0);
  x.z = from.z + step * from.slope;
  x.multipliers = tieCount() > 0 ? from.multipliers + step * from.multiplier_slope : Eigen::VectorXd();
  return x;
}

double EquilibriumSolver::softestMode(const Equilibrium& x, Eigen::VectorXd& mode, int iterations) const {
  const Eigen::VectorXd closed = Eigen::VectorXd::Zero(tieCount());
  mode.resize(x.z.size());
  for (int k = 0; k < mode.size(); ++k) mode(k) = std::sin(1.7 * k + 0.3);  // no symmetry of a body has this
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
  const SparsePattern& pattern = problem().pattern();
  double terms = 0;
  for (int c = 0; c < pattern.size; ++c) terms += std::abs(x.at.hessian[pattern.start[c]]) * mode(c) * mode(c);
  return std::abs(mode.dot(pattern.multiply(x.at.hessian, mode))) > ROUNDING * terms;
}

}  // namespace snapwing::solver
