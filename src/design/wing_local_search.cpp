// One gradient run on the wing problem. Lengths are scaled to centimetres, so that all numbers are of order one.
#include <algorithm>
#include <cmath>
#include <nlopt.hpp>

#include "snapwing/design/wing_design.h"

namespace snapwing::design {

using Eigen::Vector4d;

namespace {

constexpr double UNIT = 0.01;  ///< [m]

/// Values of the last point asked for: objective and constraints come from one evaluation.
class CachedProblem {
 public:
  explicit CachedProblem(const WingProblem& problem) : problem_(problem) {}
  const WingEvaluation& at(const double* y) {
    const Vector4d X = UNIT * Vector4d(y[0], y[1], y[2], y[3]);
    if (count_ == 0 || X != X_) {
      X_ = X;
      last_ = problem_.evaluate(X, true);
      if (!std::isfinite(last_.objective) || !last_.gradient.allFinite() || !last_.jacobian.allFinite()) {
        throw nlopt::forced_stop();
      }
      ++count_;
      remember();
    }
    return last_;
  }
  int count() const { return count_; }
  const LocalResult& best() const { return best_; }

 private:
  void remember() {
    const double violation = std::max(0.0, last_.constraints.maxCoeff());
    const bool feasible = violation <= 1e-7, had = count_ > 1, was = best_.violation <= 1e-7;
    const bool better = feasible ? (!was || last_.objective < best_.objective) : (!was && violation < best_.violation);
    if (!had || better) {
      best_.X = X_;
      best_.objective = last_.objective;
      best_.violation = violation;
    }
  }
  const WingProblem& problem_;
  Vector4d X_;
  WingEvaluation last_;
  LocalResult best_;
  int count_ = 0;
};

double objective(unsigned, const double* y, double* gradient, void* data) {
  const WingEvaluation& e = static_cast<CachedProblem*>(data)->at(y);
  for (int i = 0; gradient && i < 4; ++i) gradient[i] = e.gradient[i] / UNIT;
  return e.objective / (UNIT * UNIT);
}

void constraints(unsigned m, double* values, unsigned, const double* y, double* gradient, void* data) {
  const WingEvaluation& e = static_cast<CachedProblem*>(data)->at(y);
  for (unsigned k = 0; k < m; ++k) {
    values[k] = e.constraints[k];
    for (int i = 0; gradient && i < 4; ++i) gradient[4 * k + i] = e.jacobian(k, i) * UNIT;
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

std::string runNlopt(const WingProblem& problem, nlopt::algorithm algorithm, std::vector<double> y,
                     CachedProblem* cache) {
  nlopt::opt optimizer(algorithm, 4);
  const Vector4d low = problem.low() / UNIT, high = problem.high() / UNIT;
  optimizer.set_lower_bounds({low[0], low[1], low[2], low[3]});
  optimizer.set_upper_bounds({high[0], high[1], high[2], high[3]});
  optimizer.set_min_objective(objective, cache);
  const std::vector<double> tolerance(problem.constraintCount(), 1e-8);
  optimizer.add_inequality_mconstraint(constraints, cache, tolerance);
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

LocalResult improve(const WingProblem& problem, const Vector4d& X) {
  const Vector4d inside = X.cwiseMax(problem.low()).cwiseMin(problem.high()) / UNIT;
  CachedProblem cache(problem);
  const auto algorithm = problem.settings().optimizer == "nlopt_slsqp" ? nlopt::LD_SLSQP : nlopt::LD_MMA;
  const std::string stop = runNlopt(problem, algorithm, {inside[0], inside[1], inside[2], inside[3]}, &cache);
  LocalResult result = cache.best();
  result.evaluations = cache.count();
  result.stop = stop;
  return result;
}

}  // namespace snapwing::design
