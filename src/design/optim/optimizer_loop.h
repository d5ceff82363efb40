#pragma once
/// The outer loop that the optimisers share: evaluate, report, stop or step.

#include <functional>

#include "snapwing/design/optim/optimizer.h"

namespace snapwing::design {

/// The next x from an evaluation at result.state.x. It may change the state's asymptotes and counts its evaluations.
using OptimizerStep = std::function<Eigen::VectorXd(const Evaluated& at, OptimizerResult& result)>;

/// @throws common::Error if the start has the wrong size
OptimizerResult iterate(const OptimizerSettings& settings, OptimizationProblem& problem, const OptimizerState& start,
                        const OptimizerStep& step);

}  // namespace snapwing::design
