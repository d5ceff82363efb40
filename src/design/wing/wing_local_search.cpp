// One gradient run on the wing problem.
#include "wing_local_search.h"

#include <algorithm>
#include <cmath>
#include <nlopt.hpp>

namespace snapwing::design {

using Eigen::Vector4d;

const WingEvaluation* WingRun::at(const Vector4d& X) {
  halted_ = halted_ || (cancelled_ && cancelled_());
  if (halted_) return nullptr;
  if (best_.evaluations == 0 || X != X_) {
    X_ = X;
    last_ = problem_.evaluate(X, true);
    ++best_.evaluations;
    finite_ = std::isfinite(last_.objective) && last_.gradient.allFinite() && last_.constraints.allFinite() &&
              last_.jacobian.allFinite();
    if (finite_) remember();
  }
  return finite_ ? &last_ : nullptr;
}

void WingRun::remember() {
  constexpr double HOLDS = 1e-7;
  const double violation = std::max(0.0, last_.constraints.maxCoeff());
  const bool feasible = violation <= HOLDS, was = best_.violation <= HOLDS;
  const bool better = feasible ? (!was || last_.objective < best_.objective) : (!was && violation < best_.violation);
  if (!better) return;
  best_.X = X_;
  best_.objective = last_.objective;
  best_.violation = violation;
}

namespace {

const WingEvaluation& evaluated(const double* y, void* data) {
  const WingEvaluation* e = static_cast<WingRun*>(data)->at(SEARCH_UNIT * Vector4d(y[0], y[1], y[2], y[3]));
  if (e == nullptr) throw nlopt::forced_stop();
  return *e;
}

double objective(unsigned, const double* y, double* gradient, void* data) {
  const WingEvaluation& e = evaluated(y, data);
  for (int i = 0; gradient && i < 4; ++i) gradient[i] = e.gradient[i] / SEARCH_UNIT;
  return e.objective / (SEARCH_UNIT * SEARCH_UNIT);
}

void constraints(unsigned m, double* values, unsigned, const double* y, double* gradient, void* data) {
  const WingEvaluation& e = evaluated(y, data);
  for (unsigned k = 0; k < m; ++k) {
    values[k] = e.constraints[k];
    for (int i = 0; gradient && i < 4; ++i) gradient[4 * k + i] = e.jacobian(k, i) * SEARCH_UNIT;
  }
}

std::string stopName(nlopt::result code) {
  switch (code) {
    case nlopt::XTOL_REACHED:
      return "step below tolerance";
    case nlopt::FTOL_REACHED:
      return "objective below tolerance";
    case nlopt::MAXEVAL_REACHED:
      return "evaluations used up";
    default:
      return "nlopt code " + std::to_string(static_cast<int>(code));
  }
}

std::string runNlopt(const WingProblem& problem, nlopt::algorithm algorithm, std::vector<double> y, WingRun* run) {
  nlopt::opt optimizer(algorithm, 4);
  const Vector4d low = problem.low() / SEARCH_UNIT, high = problem.high() / SEARCH_UNIT;
  optimizer.set_lower_bounds({low[0], low[1], low[2], low[3]});
  optimizer.set_upper_bounds({high[0], high[1], high[2], high[3]});
  optimizer.set_min_objective(objective, run);
  const std::vector<double> tolerance(problem.constraintCount(), 1e-8);
  optimizer.add_inequality_mconstraint(constraints, run, tolerance);
  optimizer.set_maxeval(problem.settings().evaluations);
  optimizer.set_xtol_rel(1e-9);
  optimizer.set_ftol_rel(1e-12);
  try {
    double value = 0;
    return stopName(optimizer.optimize(y, value));
  } catch (const nlopt::forced_stop&) {
    return "evaluation not finite";
  } catch (const nlopt::roundoff_limited&) {
    return "rounding";
  } catch (const std::runtime_error& e) {
    return std::string("nlopt: ") + e.what();
  }
}

}  // namespace

LocalResult improve(const WingProblem& problem, const Vector4d& X, const std::function<bool()>& cancelled) {
  const Vector4d inside = X.cwiseMax(problem.low()).cwiseMin(problem.high());
  const std::string& name = problem.settings().optimizer;
  WingRun run(problem, cancelled);
  std::string stop;
  if (name == "own_mma") {
    stop = runOwnMma(problem, inside, &run);
  } else {
    const Vector4d y = inside / SEARCH_UNIT;
    stop = runNlopt(problem, name == "nlopt_mma" ? nlopt::LD_MMA : nlopt::LD_SLSQP, {y[0], y[1], y[2], y[3]}, &run);
  }
  LocalResult result = run.best();
  result.stop = run.halted() ? CANCELLED_RUN : stop;
  return result;
}

}  // namespace snapwing::design
