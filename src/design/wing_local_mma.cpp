// The design floor's own MMA on the wing problem, in centimetres like the other local searches.
#include <cmath>

#include "snapwing/design/optimizer.h"
#include "wing_local_search.h"

namespace snapwing::design {

using Eigen::Vector4d;
using Eigen::VectorXd;

namespace {

/// The wing problem as the general optimiser sees it.
class Adapter : public OptimizationProblem {
 public:
  Adapter(const WingProblem& problem, WingRun* run) : problem_(problem), run_(run) {}
  int variableCount() const override { return 4; }
  int constraintCount() const override { return problem_.constraintCount(); }
  VectorXd lower() const override { return problem_.low() / SEARCH_UNIT; }
  VectorXd upper() const override { return problem_.high() / SEARCH_UNIT; }

  Evaluated evaluate(const VectorXd& x, bool) override {
    Evaluated result;
    const WingEvaluation* e = run_->at(SEARCH_UNIT * Vector4d(x));
    if (e == nullptr) {
      result.message = "the linkage cannot be evaluated there";
      return result;
    }
    result.valid = true;
    result.objective = e->objective / (SEARCH_UNIT * SEARCH_UNIT);
    result.gradient = e->gradient / SEARCH_UNIT;
    result.constraints = e->constraints;
    result.jacobian = e->jacobian * SEARCH_UNIT;
    return result;
  }

 private:
  const WingProblem& problem_;
  WingRun* run_;
};

}  // namespace

std::string runOwnMma(const WingProblem& problem, const Vector4d& start, WingRun* run) {
  OptimizerSettings settings;
  settings.iterations = problem.settings().evaluations;
  settings.move = 0.05;
  settings.tolerance = 1e-6;
  settings.feasibility = 1e-6;
  Adapter adapter(problem, run);
  OptimizerState state;
  state.x = start / SEARCH_UNIT;
  const OptimizerResult result = makeMma(settings)->run(adapter, state);
  return "own MMA: " + nameOf(result.status);
}

}  // namespace snapwing::design
