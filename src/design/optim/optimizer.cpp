#include "snapwing/design/optim/optimizer.h"

#include "snapwing/common/require.h"

namespace snapwing::design {

std::string nameOf(OptimizerStatus status) {
  switch (status) {
    case OptimizerStatus::NOT_RUN:
      return "not run";
    case OptimizerStatus::CONVERGED:
      return "converged";
    case OptimizerStatus::ITERATION_LIMIT:
      return "iteration limit";
    case OptimizerStatus::INFEASIBLE:
      return "infeasible";
    case OptimizerStatus::EVALUATION_FAILED:
      return "evaluation failed";
    case OptimizerStatus::CANCELLED:
      return "cancelled";
  }
  return "unknown";
}

OptimizerStatus optimizerStatusOf(const std::string& name) {
  for (const OptimizerStatus status :
       {OptimizerStatus::CONVERGED, OptimizerStatus::ITERATION_LIMIT, OptimizerStatus::INFEASIBLE,
        OptimizerStatus::EVALUATION_FAILED, OptimizerStatus::CANCELLED}) {
    if (nameOf(status) == name) return status;
  }
  return OptimizerStatus::NOT_RUN;
}

void OptimizerSettings::validate() const {
  const common::Require require;
  require(iterations >= 1, "iterations", iterations, ">= 1");
  require(move > 0 && move <= 1, "move", move, "(0, 1]");
  require(tolerance >= 0 && tolerance < 1, "tolerance", tolerance, "[0, 1)");
  require(feasibility > 0, "feasibility", feasibility, "> 0");
  require(penalty > 0, "penalty", penalty, "> 0");
  require(asymptote_start > 0 && asymptote_start <= 10, "asymptote_start", asymptote_start, "(0, 10]");
  require(asymptote_shrink > 0 && asymptote_shrink < 1, "asymptote_shrink", asymptote_shrink, "(0, 1)");
  require(asymptote_grow >= 1 && asymptote_grow < 3, "asymptote_grow", asymptote_grow, "[1, 3)");
}

}  // namespace snapwing::design
