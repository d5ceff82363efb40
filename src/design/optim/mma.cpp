// Method of moving asymptotes: K. Svanberg, Int. J. Numer. Meth. Engng 24 (1987) 359; globally convergent version:
// SIAM J. Optim. 12 (2002) 555.
#include <algorithm>
#include <cmath>

#include "mma_subproblem.h"
#include "optimizer_loop.h"
#include "snapwing/design/optim/optimizer.h"

namespace snapwing::design {

namespace {

class Mma : public Optimizer {
 public:
  explicit Mma(const OptimizerSettings& settings) : settings_(settings) { settings_.validate(); }
  OptimizerResult run(OptimizationProblem& problem, const OptimizerState& start) const override;

 private:
  void moveAsymptotes(OptimizerState& s, const Eigen::VectorXd& range) const;
  MmaSubproblem approximate(const OptimizerState& s, const Evaluated& at, const Eigen::VectorXd& rho,
                            const OptimizationProblem& problem) const;
  Eigen::VectorXd step(OptimizationProblem& problem, const OptimizerState& s, const Evaluated& at, Eigen::VectorXd& rho,
                       OptimizerResult& result) const;

  OptimizerSettings settings_;
};

void Mma::moveAsymptotes(OptimizerState& s, const Eigen::VectorXd& range) const {
  const bool first = s.x_older.size() == 0 || s.low.size() == 0;
  if (first) s.low = s.high = s.x;
  for (Eigen::Index j = 0; j < s.x.size(); ++j) {
    double below = settings_.asymptote_start * range(j), above = below;
    if (!first) {
      const double sign = (s.x(j) - s.x_old(j)) * (s.x_old(j) - s.x_older(j));
      const double factor = sign > 0 ? settings_.asymptote_grow : sign < 0 ? settings_.asymptote_shrink : 1.0;
      below = std::clamp(factor * (s.x_old(j) - s.low(j)), 0.01 * range(j), 10 * range(j));
      above = std::clamp(factor * (s.high(j) - s.x_old(j)), 0.01 * range(j), 10 * range(j));
    }
    s.low(j) = s.x(j) - below;
    s.high(j) = s.x(j) + above;
  }
}

/// Approximation that agrees with value and gradient at x; rho adds curvature (GCMMA).
MmaSubproblem Mma::approximate(const OptimizerState& s, const Evaluated& at, const Eigen::VectorXd& rho,
                               const OptimizationProblem& problem) const {
  const Eigen::VectorXd lower = problem.lower(), upper = problem.upper();
  const Eigen::ArrayXd range = (upper - lower).array();
  const int n = static_cast<int>(s.x.size()), m = static_cast<int>(at.constraints.size());
  MmaSubproblem sub;
  sub.low = s.low, sub.high = s.high, sub.penalty = settings_.penalty;
  const Eigen::ArrayXd x = s.x.array();
  const Eigen::ArrayXd above = s.high.array() - x, below = x - s.low.array();
  sub.alpha = (x - 0.9 * below).max(x - settings_.move * range).max(lower.array());
  sub.beta = (x + 0.9 * above).min(x + settings_.move * range).min(upper.array());
  sub.p.resize(n, m + 1), sub.q.resize(n, m + 1), sub.r.resize(m + 1);
  for (int i = 0; i <= m; ++i) {
    const Eigen::ArrayXd g = i == 0 ? at.gradient : Eigen::VectorXd(at.jacobian.row(i - 1).transpose());
    const Eigen::ArrayXd rise = g.max(0.0), fall = (-g).max(0.0), extra = rho(i) / range;
    sub.p.col(i) = above.square() * (1.001 * rise + 0.001 * fall + extra);
    sub.q.col(i) = below.square() * (0.001 * rise + 1.001 * fall + extra);
    const double value = i == 0 ? at.objective : at.constraints(i - 1);
    sub.r(i) = value - (sub.p.col(i).array() / above + sub.q.col(i).array() / below).sum();
  }
  return sub;
}

Eigen::VectorXd Mma::step(OptimizationProblem& problem, const OptimizerState& s, const Evaluated& at,
                          Eigen::VectorXd& rho, OptimizerResult& result) const {
  if (!settings_.conservative) return approximate(s, at, rho, problem).solve();
  const Eigen::ArrayXd range = (problem.upper() - problem.lower()).array();
  const double n = static_cast<double>(s.x.size());
  rho(0) = std::max(1e-6, 0.1 / n * (at.gradient.array().abs() * range).sum());
  for (Eigen::Index i = 1; i < rho.size(); ++i) {
    rho(i) = std::max(1e-6, 0.1 / n * (at.jacobian.row(i - 1).transpose().array().abs() * range).sum());
  }
  Eigen::VectorXd x;
  for (int inner = 0; inner < 15; ++inner) {
    const MmaSubproblem sub = approximate(s, at, rho, problem);
    x = sub.solve();
    const Evaluated trial = problem.evaluate(x, false);
    ++result.evaluations;
    if (!trial.valid) {
      rho *= 10;
      continue;
    }
    const Eigen::ArrayXd up = s.high.array(), low = s.low.array(), xa = x.array(), xk = s.x.array();
    const double d = ((up - low) * (xa - xk).square() / ((up - xa) * (xa - low) * range)).sum();
    const Eigen::VectorXd model = sub.values(x);
    bool good = true;
    for (Eigen::Index i = 0; i < rho.size(); ++i) {
      const double excess = (i == 0 ? trial.objective : trial.constraints(i - 1)) - model(i);
      if (excess <= 1e-7 * (1 + std::abs(model(i))) || d <= 0) continue;
      good = false;
      rho(i) = std::min(10 * rho(i), 1.1 * (rho(i) + excess / d));
    }
    if (good) break;
  }
  return x;
}

OptimizerResult Mma::run(OptimizationProblem& problem, const OptimizerState& start) const {
  const Eigen::VectorXd range = problem.upper() - problem.lower();
  Eigen::VectorXd rho = Eigen::VectorXd::Constant(problem.constraintCount() + 1, 1e-5);
  return iterate(settings_, problem, start, [&](const Evaluated& at, OptimizerResult& result) {
    moveAsymptotes(result.state, range);
    return step(problem, result.state, at, rho, result);
  });
}

}  // namespace

std::unique_ptr<Optimizer> makeMma(const OptimizerSettings& settings) { return std::make_unique<Mma>(settings); }

}  // namespace snapwing::design
