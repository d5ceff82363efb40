#include "optimizer_loop.h"

#include <algorithm>
#include <chrono>

#include "snapwing/common/error.h"

namespace snapwing::design {

namespace {

constexpr int RETREATS = 6;

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// Evaluates at the state's x; after a step too far goes back towards what could be evaluated.
Evaluated evaluateNear(OptimizationProblem& problem, OptimizerResult& result) {
  OptimizerState& s = result.state;
  Evaluated at = problem.evaluate(s.x, true);
  ++result.evaluations;
  for (int back = 0; !at.valid && back < RETREATS && s.x_old.size() > 0; ++back) {
    s.x = 0.5 * (s.x + s.x_old);
    at = problem.evaluate(s.x, true);
    ++result.evaluations;
  }
  return at;
}

}  // namespace

OptimizerResult iterate(const OptimizerSettings& settings, OptimizationProblem& problem, const OptimizerState& start,
                        const OptimizerStep& step) {
  const double begin = now();
  OptimizerResult result;
  OptimizerState& s = result.state;
  s = start;
  const Eigen::VectorXd lower = problem.lower(), upper = problem.upper(), range = upper - lower;
  if (s.x.size() != problem.variableCount()) throw common::Error("optimizer: the start has the wrong size");
  s.x = s.x.cwiseMax(lower).cwiseMin(upper);
  const auto finish = [&](OptimizerStatus status, const std::string& message) {
    result.status = status;
    result.message = message;
    result.seconds = now() - begin;
    return result;
  };
  for (;; ++s.iteration) {
    problem.beginIteration(s.iteration, settings.iterations);
    const Evaluated at = evaluateNear(problem, result);
    if (!at.valid) return finish(OptimizerStatus::EVALUATION_FAILED, at.message);
    const double change = s.x_old.size() > 0 ? ((s.x - s.x_old).cwiseQuotient(range)).cwiseAbs().maxCoeff() : 1;
    result.objective = at.objective;
    result.violation = at.constraints.size() > 0 ? std::max(0.0, at.constraints.maxCoeff()) : 0;
    result.history.push_back({s.iteration, at.objective, result.violation, change, now() - begin, at.constraints});
    const bool feasible = result.violation <= settings.feasibility;
    if (feasible && s.iteration >= settings.least_iterations) s.x_feasible = s.x;
    if (settings.progress && settings.progress(result.history.back(), s)) {
      return finish(OptimizerStatus::CANCELLED, "cancelled");
    }
    if (change < settings.tolerance && feasible && s.iteration >= settings.least_iterations) {
      return finish(OptimizerStatus::CONVERGED, "");
    }
    if (s.iteration + 1 >= settings.iterations) {
      if (feasible) return finish(OptimizerStatus::ITERATION_LIMIT, "");
      // Iterates hop over a bound by their move limit: one more evaluation, where all were met last.
      if (s.iteration + 1 == settings.iterations && s.x_feasible.size() > 0) {
        s.x_older = s.x_old, s.x_old = s.x, s.x = s.x_feasible;
        continue;
      }
      return finish(OptimizerStatus::INFEASIBLE, "largest violation " + std::to_string(result.violation));
    }
    const Eigen::VectorXd next = step(at, result);
    s.x_older = s.x_old;
    s.x_old = s.x;
    s.x = next;
  }
}

}  // namespace snapwing::design
