// NLopt's LD_MMA in stages: it knows no move limit, so each stage runs within x +- move.
#include <algorithm>
#include <nlopt.hpp>

#include "optimizer_loop.h"
#include "snapwing/common/error.h"
#include "snapwing/design/optim/optimizer.h"

namespace snapwing::design {

namespace {

/// NLopt asks for values and constraints one by one: the last evaluation is kept.
struct Cache {
  OptimizationProblem& problem;
  Eigen::VectorXd x;
  Evaluated value;
  int evaluations = 0;

  const Evaluated& at(const std::vector<double>& point) {
    const Eigen::Map<const Eigen::VectorXd> wanted(point.data(), static_cast<Eigen::Index>(point.size()));
    if (x.size() != wanted.size() || x != wanted) {
      x = wanted;
      value = problem.evaluate(x, true);
      ++evaluations;
    }
    return value;
  }
};

struct ConstraintOf {
  Cache* cache;
  int row;
};

void check(const Evaluated& e) {
  if (!e.valid) throw nlopt::forced_stop();
}

double objectiveOf(const std::vector<double>& x, std::vector<double>& gradient, void* data) {
  const Evaluated& e = static_cast<Cache*>(data)->at(x);
  check(e);
  if (!gradient.empty()) std::copy(e.gradient.data(), e.gradient.data() + e.gradient.size(), gradient.begin());
  return e.objective;
}

double constraintOf(const std::vector<double>& x, std::vector<double>& gradient, void* data) {
  const auto* which = static_cast<ConstraintOf*>(data);
  const Evaluated& e = which->cache->at(x);
  check(e);
  for (std::size_t j = 0; j < gradient.size(); ++j) gradient[j] = e.jacobian(which->row, static_cast<Eigen::Index>(j));
  return e.constraints(which->row);
}

class NloptMma : public Optimizer {
 public:
  NloptMma(const OptimizerSettings& settings, int stage) : settings_(settings), stage_(stage) {
    settings_.validate();
    if (stage < 1) throw common::Error("stage_evaluations is " + std::to_string(stage) + "; allowed: >= 1");
  }

  OptimizerResult run(OptimizationProblem& problem, const OptimizerState& start) const override {
    return iterate(settings_, problem, start, [&](const Evaluated& at, OptimizerResult& result) {
      return stage(problem, result.state.x, at, result.evaluations);
    });
  }

 private:
  Eigen::VectorXd stage(OptimizationProblem& problem, const Eigen::VectorXd& x, const Evaluated& at,
                        int& evaluations) const {
    const Eigen::VectorXd lower = problem.lower(), upper = problem.upper(), reach = settings_.move * (upper - lower);
    const Eigen::VectorXd low = (x - reach).cwiseMax(lower), high = (x + reach).cwiseMin(upper);
    const auto n = static_cast<unsigned>(x.size());
    nlopt::opt opt(nlopt::LD_MMA, n);
    Cache cache{problem, x, at};
    std::vector<ConstraintOf> rows(static_cast<std::size_t>(problem.constraintCount()));
    opt.set_min_objective(objectiveOf, &cache);
    opt.set_lower_bounds(std::vector<double>(low.data(), low.data() + n));
    opt.set_upper_bounds(std::vector<double>(high.data(), high.data() + n));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      rows[i] = {&cache, static_cast<int>(i)};
      opt.add_inequality_constraint(constraintOf, &rows[i], 1e-8);
    }
    opt.set_maxeval(stage_);
    std::vector<double> point(x.data(), x.data() + n);
    double value = 0;
    try {
      opt.optimize(point, value);
    } catch (const nlopt::forced_stop&) {  // an evaluation failed: what was reached counts
    } catch (const nlopt::roundoff_limited&) {
    }
    evaluations += cache.evaluations;
    return Eigen::Map<Eigen::VectorXd>(point.data(), n);
  }

  OptimizerSettings settings_;
  int stage_;
};

}  // namespace

std::unique_ptr<Optimizer> makeNloptMma(const OptimizerSettings& settings, int stage_evaluations) {
  return std::make_unique<NloptMma>(settings, stage_evaluations);
}

}  // namespace snapwing::design
