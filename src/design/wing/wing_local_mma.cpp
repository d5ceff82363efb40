// The design layer's own MMA on the wing problem. Its approximations are separable, and the wing's objective is a
// valley a hundred times steeper across than along that runs askew to the coordinates: in X itself the method swings
// from wall to wall. So it works in rounds, each in coordinates y of the objective's curvature at the round's start,
//   x = x0 + Q diag(1 / sqrt(lambda)) y,   H = Q diag(lambda) Q^T by differences of the gradient,
// in which the valley is round, with the conservative variant (GCMMA), which never accepts a step above its model.
#include <Eigen/Eigenvalues>
#include <cmath>

#include "snapwing/design/optim/optimizer.h"
#include "wing_local_search.h"

namespace snapwing::design {

using Eigen::Matrix4d;
using Eigen::Vector4d;
using Eigen::VectorXd;

namespace {

constexpr int ROUND = 12;            ///< iterations of a round
constexpr double DIFFERENCE = 1e-4;  ///< of the Hessian's differences [search units]
constexpr double FLATTEST = 1e-4;    ///< least curvature that counts, of the largest
constexpr double REACH = 2;          ///< half width of a round's box, in steps that would halve the objective or so
constexpr double STALLED = 1e-7;     ///< relative gain of a round that ends the run
constexpr int BOX_ROWS = 8;

/// One round as the general optimiser sees it; the box of X becomes eight linear rows.
class Round : public OptimizationProblem {
 public:
  Round(const WingProblem& problem, WingRun* run, const Vector4d& x0, const Matrix4d& S, double reach)
      : problem_(problem), run_(run), x0_(x0), S_(S), reach_(reach) {}
  int variableCount() const override { return 4; }
  int constraintCount() const override { return problem_.constraintCount() + BOX_ROWS; }
  VectorXd lower() const override { return VectorXd::Constant(4, -reach_); }
  VectorXd upper() const override { return VectorXd::Constant(4, reach_); }
  Vector4d at(const VectorXd& y) const { return x0_ + S_ * y; }

  Evaluated evaluate(const VectorXd& y, bool) override {
    Evaluated result;
    const Vector4d x = at(y);
    const WingEvaluation* e = run_->at(SEARCH_UNIT * x);
    if (e == nullptr) {
      result.message = "the linkage cannot be evaluated there";
      return result;
    }
    result.valid = true;
    result.objective = e->objective / (SEARCH_UNIT * SEARCH_UNIT);
    result.gradient = S_.transpose() * e->gradient / SEARCH_UNIT;
    const int m = problem_.constraintCount();
    result.constraints.resize(m + BOX_ROWS);
    result.jacobian.resize(m + BOX_ROWS, 4);
    result.constraints << e->constraints, problem_.low() / SEARCH_UNIT - x, x - problem_.high() / SEARCH_UNIT;
    result.jacobian << e->jacobian * SEARCH_UNIT * S_, -S_, S_;
    return result;
  }

 private:
  const WingProblem& problem_;
  WingRun* run_;
  Vector4d x0_;
  Matrix4d S_;
  double reach_;
};

/// Q diag(1 / sqrt(lambda)) of the objective at x; the unit matrix where it cannot be had.
Matrix4d roundCoordinates(WingRun* run, const Vector4d& x) {
  Matrix4d H;
  for (int k = 0; k < 4; ++k) {
    Vector4d side[2];
    for (int s = 0; s < 2; ++s) {
      const WingEvaluation* e = run->at(SEARCH_UNIT * (x + (s == 0 ? -DIFFERENCE : DIFFERENCE) * Vector4d::Unit(k)));
      if (e == nullptr) return Matrix4d::Identity();
      side[s] = e->gradient / SEARCH_UNIT;
    }
    H.col(k) = (side[1] - side[0]) / (2 * DIFFERENCE);
  }
  const Eigen::SelfAdjointEigenSolver<Matrix4d> eigen(0.5 * (H + H.transpose()));
  const Vector4d curvature =
      eigen.eigenvalues().cwiseAbs().cwiseMax(FLATTEST * eigen.eigenvalues().cwiseAbs().maxCoeff());
  return eigen.eigenvectors() * curvature.cwiseSqrt().cwiseInverse().asDiagonal();
}

}  // namespace

std::string runOwnMma(const WingProblem& problem, const Vector4d& start, WingRun* run) {
  OptimizerSettings settings;
  settings.iterations = ROUND;
  settings.move = 0.5;
  settings.tolerance = 1e-7;
  settings.feasibility = 1e-6;
  settings.conservative = true;
  const int most = problem.settings().evaluations;
  settings.progress = [&](const OptimizerReport&, const OptimizerState&) { return run->best().evaluations >= most; };
  Vector4d x = start / SEARCH_UNIT;
  double last = std::numeric_limits<double>::infinity();
  while (run->best().evaluations < most) {
    const WingEvaluation* e = run->at(SEARCH_UNIT * x);
    if (e == nullptr) return "own MMA: evaluation not finite";
    const double reach = REACH * std::sqrt(2 * e->objective) / SEARCH_UNIT;
    Round round(problem, run, x, roundCoordinates(run, x), reach);
    OptimizerState state;
    state.x = VectorXd::Zero(4);
    const OptimizerResult result = makeMma(settings)->run(round, state);
    x = round.at(result.state.x);
    const bool feasible = result.violation <= settings.feasibility;
    if (feasible && std::abs(last - result.objective) <= STALLED * result.objective) return "own MMA: converged";
    if (feasible) last = result.objective;
  }
  return "own MMA: evaluations used up";
}

}  // namespace snapwing::design
