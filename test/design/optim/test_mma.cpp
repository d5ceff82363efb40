// Optimisers on published problems with known optima, and on small ones with closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "mma_subproblem.h"
#include "snapwing/common/error.h"
#include "snapwing/design/optim/optimizer.h"

namespace snapwing::design {
namespace {

/// Svanberg 1987, section 5.1: cantilever of five square tubes. min 0.0624 sum x, sum k_j / x_j^3 <= 1,
/// k = (61, 37, 19, 7, 1). Stationarity gives x_j ~ k_j^(1/4) exactly.
class Cantilever : public OptimizationProblem {
 public:
  int variableCount() const override { return 5; }
  int constraintCount() const override { return 1; }
  Eigen::VectorXd lower() const override { return Eigen::VectorXd::Constant(5, 1.0); }
  Eigen::VectorXd upper() const override { return Eigen::VectorXd::Constant(5, 10.0); }
  Evaluated evaluate(const Eigen::VectorXd& x, bool) override {
    ++evaluations;
    Evaluated e;
    e.valid = true;
    e.objective = 0.0624 * x.sum();
    e.gradient = Eigen::VectorXd::Constant(5, 0.0624);
    e.constraints = Eigen::VectorXd::Constant(1, (k().array() / x.array().cube()).sum() - 1);
    e.jacobian = (-3 * k().array() / x.array().pow(4)).matrix().transpose();
    return e;
  }
  static Eigen::VectorXd k() { return (Eigen::VectorXd(5) << 61, 37, 19, 7, 1).finished(); }
  static Eigen::VectorXd optimum() {
    const Eigen::ArrayXd shape = k().array().pow(0.25);
    return (shape * std::cbrt((k().array() / shape.cube()).sum())).matrix();
  }
  int evaluations = 0;
};

/// Svanberg 1987, section 5.2: two-bar truss, f = x1 sqrt(1 + x2^2), stresses of both bars <= 1; optimum about
/// (1.41, 0.38) with f = 1.51.
class TwoBarTruss : public OptimizationProblem {
 public:
  int variableCount() const override { return 2; }
  int constraintCount() const override { return 2; }
  Eigen::VectorXd lower() const override { return Eigen::Vector2d(0.2, 0.1); }
  Eigen::VectorXd upper() const override { return Eigen::Vector2d(4.0, 1.6); }
  Evaluated evaluate(const Eigen::VectorXd& x, bool) override {
    Evaluated e;
    e.valid = true;
    const double a = x(0), b = x(1), root = std::sqrt(1 + b * b);
    e.objective = a * root;
    e.gradient = Eigen::Vector2d(root, a * b / root);
    e.constraints.resize(2), e.jacobian.resize(2, 2);
    for (int i = 0; i < 2; ++i) {
      const double s = i == 0 ? 1 : -1, term = 8 / a + s / (a * b);
      e.constraints(i) = 0.124 * root * term - 1;
      e.jacobian(i, 0) = 0.124 * root * (-8 / (a * a) - s / (a * a * b));
      e.jacobian(i, 1) = 0.124 * (b / root * term - root * s / (a * b * b));
    }
    return e;
  }
};

/// Rosenbrock's valley in a disc of radius sqrt(2): optimum (1, 1) on its edge.
class Valley : public OptimizationProblem {
 public:
  int variableCount() const override { return 2; }
  int constraintCount() const override { return 1; }
  Eigen::VectorXd lower() const override { return Eigen::Vector2d(-1.5, -1.5); }
  Eigen::VectorXd upper() const override { return Eigen::Vector2d(1.5, 1.5); }
  Evaluated evaluate(const Eigen::VectorXd& x, bool) override {
    Evaluated e;
    e.valid = true;
    const double t = x(1) - x(0) * x(0);
    e.objective = std::pow(1 - x(0), 2) + 100 * t * t;
    e.gradient = Eigen::Vector2d(-2 * (1 - x(0)) - 400 * x(0) * t, 200 * t);
    e.constraints = Eigen::VectorXd::Constant(1, x.squaredNorm() - 2);
    e.jacobian = 2 * x.transpose();
    return e;
  }
};

OptimizerState from(const Eigen::VectorXd& x) {
  OptimizerState state;
  state.x = x;
  return state;
}

OptimizerSettings settings(int iterations, double move, bool conservative) {
  OptimizerSettings s;
  s.iterations = iterations, s.move = move, s.conservative = conservative, s.tolerance = 1e-7;
  return s;
}

TEST(Mma, SvanbergsCantilever) {
  // The published optimum, rounded: (6.016, 5.309, 4.494, 3.502, 2.153), 1.340.
  EXPECT_NEAR(0.0624 * Cantilever::optimum().sum(), 1.340, 5e-4);
  for (const bool conservative : {false, true}) {
    Cantilever problem;
    const auto r = makeMma(settings(60, 0.5, conservative))->run(problem, from(Eigen::VectorXd::Constant(5, 5.0)));
    EXPECT_EQ(r.status, OptimizerStatus::CONVERGED) << r.message;
    EXPECT_LT((r.state.x - Cantilever::optimum()).norm(), 2e-4) << r.state.x.transpose();
    EXPECT_LT(r.violation, 1e-5);
    if (!conservative) {
      EXPECT_EQ(problem.evaluations, static_cast<int>(r.history.size()));  // one an iteration
    }
  }
}

TEST(Mma, SvanbergsTwoBarTruss) {
  for (const bool conservative : {false, true}) {
    TwoBarTruss problem;
    const auto r = makeMma(settings(100, 0.3, conservative))->run(problem, from(Eigen::Vector2d(1.5, 0.5)));
    EXPECT_NEAR(r.state.x(0), 1.41, 0.005);
    EXPECT_NEAR(r.state.x(1), 0.377, 0.005);
    EXPECT_NEAR(r.objective, 1.51, 0.005);
    EXPECT_LT(r.violation, 1e-4);
  }
}

TEST(Mma, ConservativeFollowsACurvedValley) {
  Valley problem;
  const auto r = makeMma(settings(3000, 0.2, true))->run(problem, from(Eigen::Vector2d(-1.0, 0.5)));
  EXPECT_LT(r.objective, 1e-3);
  EXPECT_LT(r.violation, 1e-3);
}

TEST(Nlopt, SameOptimaInStages) {
  Cantilever cantilever;
  const auto a = makeNloptMma(settings(60, 0.1, false))->run(cantilever, from(Eigen::VectorXd::Constant(5, 5.0)));
  EXPECT_LT((a.state.x - Cantilever::optimum()).norm(), 5e-3) << a.state.x.transpose();
  TwoBarTruss truss;
  const auto b = makeNloptMma(settings(80, 0.1, false))->run(truss, from(Eigen::Vector2d(1.5, 0.5)));
  EXPECT_NEAR(b.objective, 1.51, 0.005);
}

TEST(Mma, RespectsTheMoveLimitAndResumesBitForBit) {
  Cantilever problem;
  std::vector<OptimizerState> states;
  OptimizerSettings s = settings(30, 0.02, false);
  s.progress = [&](const OptimizerReport& report, const OptimizerState& state) {
    if (report.iteration > 0) {
      EXPECT_LE(report.change, 0.02 + 1e-12);
    }
    states.push_back(state);
    return false;
  };
  const auto whole = makeMma(s)->run(problem, from(Eigen::VectorXd::Constant(5, 5.0)));
  const OptimizerState middle = states[10];
  const auto rest = makeMma(s)->run(problem, middle);
  EXPECT_EQ(whole.state.x, rest.state.x);
}

TEST(Mma, CancelAndInfeasibleAndFailureAreStatuses) {
  Cantilever problem;
  OptimizerSettings s = settings(30, 0.1, false);
  s.progress = [](const OptimizerReport& report, const OptimizerState&) { return report.iteration == 3; };
  EXPECT_EQ(makeMma(s)->run(problem, from(Eigen::VectorXd::Constant(5, 5.0))).status, OptimizerStatus::CANCELLED);

  class Impossible : public Cantilever {
    Evaluated evaluate(const Eigen::VectorXd& x, bool d) override {
      Evaluated e = Cantilever::evaluate(x, d);
      e.constraints.array() += 2;
      return e;
    }
  } impossible;
  EXPECT_EQ(makeMma(settings(40, 0.2, false))->run(impossible, from(Eigen::VectorXd::Constant(5, 5.0))).status,
            OptimizerStatus::INFEASIBLE);

  class Broken : public Cantilever {
    Evaluated evaluate(const Eigen::VectorXd&, bool) override { return {}; }
  } broken;
  EXPECT_EQ(makeMma(settings(40, 0.2, false))->run(broken, from(Eigen::VectorXd::Constant(5, 5.0))).status,
            OptimizerStatus::EVALUATION_FAILED);
}

/// A run whose last iterate leaves the bounds goes back to the latest that met them, also when it was stopped before.
TEST(Mma, EndsAtTheLatestFeasibleIterate) {
  class Hop : public Cantilever {
   public:
    void beginIteration(int k, int total) override { hop = k + 1 == total; }
    Evaluated evaluate(const Eigen::VectorXd& x, bool d) override {
      Evaluated e = Cantilever::evaluate(x, d);
      if (hop) e.constraints.array() += 0.5;
      return e;
    }
    bool hop = false;
  } problem;
  OptimizerSettings s = settings(12, 0.02, false);
  std::vector<OptimizerState> states;
  s.progress = [&](const OptimizerReport&, const OptimizerState& state) {
    states.push_back(state);
    return false;
  };
  const auto r = makeMma(s)->run(problem, from(Eigen::VectorXd::Constant(5, 7.0)));
  EXPECT_EQ(r.status, OptimizerStatus::ITERATION_LIMIT) << r.message;
  EXPECT_EQ(r.state.x, states[10].x);
  EXPECT_EQ(r.violation, 0);
  EXPECT_EQ(r.history.size(), 13U);
  const OptimizerState last = states[11];
  EXPECT_EQ(makeMma(s)->run(problem, last).state.x, r.state.x);

  s.least_iterations = 11;  // none but the last may be the end
  EXPECT_EQ(makeMma(s)->run(problem, from(Eigen::VectorXd::Constant(5, 7.0))).status, OptimizerStatus::INFEASIBLE);
}

TEST(Mma, BadSettingsAreRefused) {
  EXPECT_THROW(makeMma(settings(0, 0.1, false)), common::Error);
  EXPECT_THROW(makeMma(settings(10, 0.0, false)), common::Error);
  EXPECT_THROW(makeNloptMma(settings(10, 0.1, false), 0), common::Error);
}

TEST(MmaSubproblem, SatisfiesKkt) {
  // Two variables, three constraints, one of which is active at the solution.
  MmaSubproblem sub;
  sub.low = Eigen::Vector2d(-1, -1), sub.high = Eigen::Vector2d(2, 2);
  sub.alpha = Eigen::Vector2d(0, 0), sub.beta = Eigen::Vector2d(1, 1);
  sub.p.resize(2, 4), sub.q.resize(2, 4);
  sub.p << 0.001, 1, 0.1, 0.2, 0.001, 0.5, 0.3, 0.1;
  sub.q << 2, 0.01, 0.2, 0.1, 1, 0.01, 0.1, 0.4;
  sub.r = (Eigen::VectorXd(4) << 0, -1.2, -5, -4).finished();
  Eigen::VectorXd lambda;
  const Eigen::VectorXd x = sub.solve(&lambda), f = sub.values(x);
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(f(i + 1), 1e-6);
    EXPECT_NEAR(lambda(i) * f(i + 1), 0, 1e-6);
  }
  EXPECT_GT(lambda(0), 0.1);
  for (int j = 0; j < 2; ++j) {
    double slope = 0;
    for (int i = 0; i < 4; ++i) {
      const double weight = i == 0 ? 1 : lambda(i - 1);
      slope += weight * (sub.p(j, i) / std::pow(2 - x(j), 2) - sub.q(j, i) / std::pow(x(j) + 1, 2));
    }
    if (x(j) > 1e-6 && x(j) < 1 - 1e-6) {
      EXPECT_NEAR(slope, 0, 1e-6);
    }
  }
}

}  // namespace
}  // namespace snapwing::design
