// Paths along power series against the same paths point by point.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "snapwing/scene/scene_problem.h"
#include "snapwing/statics/automatic.h"
#include "snapwing/statics/branch_series.h"
#include "snapwing/statics/checkpoint.h"
#include "snapwing/statics/scene_curve.h"
#include "support/paths.h"

namespace snapwing::statics {
namespace {

scene::Scene beam(scene::SceneKernel kernel, double cell_size, int steps) {
  scene::Scene scene = scene::loadScene(test::sourceDir() + "/config/scenes/snap_beam.yaml");
  scene.kernel = kernel;
  scene.cell_size = cell_size;
  scene.steps = steps;
  return scene;
}

PathResult follow(const scene::Scene& scene, bool series, double tolerance = 1e-9) {
  const auto compiled = scene::compileScene(scene, 1);
  AutomaticSettings settings;
  settings.path.series = series;
  settings.path.newton.relative_tolerance = tolerance;
  std::vector<double> targets;
  for (int k = 0; k <= scene.steps; ++k) targets.push_back(scene.to * k / scene.steps);
  return followAutomatically(compiled->problem(), Eigen::VectorXd::Zero(compiled->problem().freeCount()), targets,
                             settings);
}

int count(const PathResult& path, bool PathPoint::*of) {
  return static_cast<int>(
      std::count_if(path.points.begin(), path.points.end(), [&](const PathPoint& p) { return p.*of; }));
}

/// Every point is the equilibrium that Newton finds alone, to a thousand times less than its tolerance there.
void expectSame(const PathResult& one, const PathResult& other) {
  ASSERT_EQ(one.status, solver::SolveStatus::CONVERGED) << one.message;
  ASSERT_EQ(one.points.size(), other.points.size());
  double force = 0, stiffness = 0;
  for (const PathPoint& p : other.points) {
    force = std::max(force, std::abs(p.force));
    stiffness = std::max(stiffness, std::abs(p.stiffness));
  }
  for (std::size_t k = 0; k < one.points.size(); ++k) {
    const PathPoint &a = one.points[k], &b = other.points[k];
    EXPECT_NEAR(a.force, b.force, 1e-8 * force) << k;
    EXPECT_NEAR(a.stiffness, b.stiffness, 1e-7 * stiffness) << k;
    EXPECT_LT((a.solution - b.solution).norm(), 1e-8 * b.solution.norm() + 1e-15) << k;
    EXPECT_LT((a.slope - b.slope).norm(), 1e-5 * b.slope.norm()) << k;
    EXPECT_EQ(a.negative_pivots, b.negative_pivots) << k;
  }
}

TEST(BranchSeries, FollowsTheBeamOfEveryKernel) {
  for (const auto kernel :
       {scene::SceneKernel::LINEAR, scene::SceneKernel::LINEAR_REDUCED, scene::SceneKernel::QUADRATIC}) {
    const scene::Scene scene = beam(kernel, 8e-4, 120);
    const PathResult series = follow(scene, true), plain = follow(scene, false, 1e-12);
    expectSame(series, plain);
    EXPECT_GE(series.series, 2);
    EXPECT_GT(count(series, &PathPoint::by_series), 40);
    EXPECT_EQ(plain.series, 0);
    EXPECT_EQ(count(plain, &PathPoint::by_series), 0);
    EXPECT_LT(series.factorizations, 0.75 * plain.factorizations);
  }
}

/// What is told as stable without a factor has one that is positive definite.
TEST(BranchSeries, WhatItCallsStableIs) {
  const scene::Scene scene = beam(scene::SceneKernel::LINEAR_REDUCED, 8e-4, 120);
  const PathResult path = follow(scene, true);
  const auto compiled = scene::compileScene(scene, 1);
  solver::EquilibriumSolver solver(compiled->problem(), {});
  for (const PathPoint& p : path.points) {
    if (!p.by_series) continue;
    EXPECT_TRUE(p.stable);
    solver::Equilibrium x = solver.start(p.solution, p.control);
    solver.evaluate(x);
    EXPECT_LE(solver.imbalance(x), 1) << p.control;
    solver.linearise(x);
    EXPECT_EQ(x.negative_pivots, 0) << p.control;
    EXPECT_NEAR(x.stiffness, p.stiffness, 1e-9 * std::abs(x.stiffness) + 1e-9) << p.control;
  }
}

/// The perfect beam's own branch is smooth where it turns unstable. The series ends just before, since rounding has a
/// share of the mode; what is told beyond comes of factors.
TEST(BranchSeries, DoesNotPassABifurcationUnseen) {
  scene::Scene scene = beam(scene::SceneKernel::QUADRATIC, 8e-4, 60);
  scene::Box half;
  half.low(0) = 0;
  half.high(0) = 0.04;
  scene.bodies[0].material = {5.5e6, 0, 0};
  scene.bodies[0].shape = mpm::makeIntersection({mpm::makeCosineBeam(0.08, {0.0048, 0}, 1.6e-3), mpm::makeBox(half)});
  scene.to = 0.5 * 0.0096;
  const PathResult series = follow(scene, true), plain = follow(scene, false, 1e-12);
  expectSame(series, plain);
  EXPECT_GE(series.series, 1);
  ASSERT_EQ(plain.singular.size(), 1u);
  ASSERT_EQ(series.singular.size(), 1u);
  EXPECT_EQ(series.singular[0].kind, SingularKind::BIFURCATION);
  EXPECT_NEAR(series.singular[0].point.p(0), plain.singular[0].point.p(0), 1e-6 * scene.to);
}

TEST(BranchSeries, AResumedRunHasTheSameBits) {
  const scene::Scene scene = beam(scene::SceneKernel::LINEAR_REDUCED, 8e-4, 120);
  const auto compiled = scene::compileScene(scene, 1);
  const std::string file = ::testing::TempDir() + "snapwing_series.checkpoint", hash = traceHash(scene, "");
  TraceSettings settings;
  const SceneCurve whole = traceScene(scene, *compiled, settings, {});
  ASSERT_GE(whole.path.series, 2);
  settings.reached = [&](const SceneCurve& sofar) { saveCheckpoint(sofar, hash, file); };
  for (const double stop : {4e-3, 9e-3, 14e-3}) {
    settings.resume = nullptr;
    const SceneCurve part = traceScene(scene, *compiled, settings, [&](double, double p) { return p > stop; });
    ASSERT_EQ(part.path.status, solver::SolveStatus::CANCELLED);
    const SceneCurve known = loadCheckpoint(file, hash);
    settings.resume = &known;
    const SceneCurve rest = traceScene(scene, *scene::compileScene(scene, 1), settings, {});
    EXPECT_EQ(rest.csv(scene), whole.csv(scene)) << stop;
    ASSERT_EQ(rest.path.points.size(), whole.path.points.size());
    for (std::size_t k = 0; k < whole.path.points.size(); ++k) {
      EXPECT_TRUE(rest.path.points[k].solution == whole.path.points[k].solution) << k;
    }
  }
}

/// Pi = sum_i (x_i^2/2 + a_i x_i^3/3 - p x_i) + (1 - x_0) y^2/2 + y^4/4: the branch y = 0, x_i + a_i x_i^2 = p turns
/// unstable at x_0 = 1, p = 1 + a_0, and its series knows nothing of y.
class Pitchforks : public solver::Problem {
 public:
  static constexpr int COUNT = 24;  // more than a series has orders
  static double a(int i) { return 0.1 + 0.02 * i; }
  Pitchforks() {
    pattern_.size = COUNT + 1;
    pattern_.start = {0};
    for (int i = 0; i <= COUNT; ++i) {
      pattern_.row.push_back(i);
      if (i == 0) pattern_.row.push_back(COUNT);
      pattern_.start.push_back(static_cast<int>(pattern_.row.size()));
    }
  }
  int freeCount() const override { return COUNT + 1; }
  int controlCount() const override { return 1; }
  const solver::SparsePattern& pattern() const override { return pattern_; }
  double forceFloor() const override { return 1e-14; }
  std::string describeCell(int) const override { return "point"; }
  void evaluate(const Eigen::VectorXd& z, const Eigen::VectorXd& p, solver::Order,
                solver::Evaluation& out) const override {
    const double y = z(COUNT);
    out.elastic_energy = 0.5 * (1 - z(0)) * y * y + 0.25 * y * y * y * y;
    out.residual.resize(COUNT + 1);
    out.hessian.clear();
    for (int i = 0; i < COUNT; ++i) {
      out.elastic_energy += z(i) * z(i) * (0.5 + a(i) * z(i) / 3);
      out.residual(i) = z(i) + a(i) * z(i) * z(i) - p(0) - (i == 0 ? 0.5 * y * y : 0);
      out.hessian.push_back(1 + 2 * a(i) * z(i));
      if (i == 0) out.hessian.push_back(-y);
    }
    out.residual(COUNT) = (1 - z(0)) * y + y * y * y;
    out.hessian.push_back(1 - z(0) + 3 * y * y);
    out.energy = out.elastic_energy - p(0) * z.head(COUNT).sum();
    out.control_force = Eigen::VectorXd::Constant(1, -z.head(COUNT).sum());
    out.force_scale = 1;
    out.finite = true;
  }
  void controlTangent(const solver::Evaluation&, const Eigen::VectorXd& dp, Eigen::VectorXd& free_part,
                      Eigen::VectorXd& control_part) const override {
    free_part = Eigen::VectorXd::Constant(COUNT + 1, -dp(0));
    free_part(COUNT) = 0;
    control_part = Eigen::VectorXd::Zero(1);
  }
  std::unique_ptr<solver::ResidualSeries> series(int, std::string&) const override { return std::make_unique<Along>(); }

 private:
  class Along : public solver::ResidualSeries {
   public:
    void start(const Eigen::VectorXd& z, const Eigen::VectorXd&) override { z_ = {z}; }
    Eigen::VectorXd advance(int k, const Eigen::VectorXd& z, const Eigen::VectorXd&) override {
      z_.push_back(z);
      Eigen::VectorXd sum = Eigen::VectorXd::Zero(z.size());
      for (int n = 1; n <= k; ++n) {
        for (int i = 0; i < COUNT; ++i) sum(i) += a(i) * z_[n](i) * z_[k + 1 - n](i);
      }
      return sum;
    }

   private:
    std::vector<Eigen::VectorXd> z_;
  };
  solver::SparsePattern pattern_;
};

TEST(BranchSeries, FactorsTellWhatASeriesDoesNot) {
  const Pitchforks problem;
  PathSettings settings;
  settings.series = true;
  settings.locate_singular = false;
  std::vector<double> targets;
  for (int k = 0; k <= 80; ++k) targets.push_back(0.02 * k);
  const PathResult path = PathFollower(problem, settings).follow(Eigen::VectorXd::Zero(problem.freeCount()), targets);
  ASSERT_EQ(path.status, solver::SolveStatus::CONVERGED) << path.message;
  EXPECT_GT(count(path, &PathPoint::by_series), 10);
  int unstable = 0;
  for (const PathPoint& p : path.points) {
    const double x = p.solution(0);
    ASSERT_EQ(p.solution(Pitchforks::COUNT), 0);
    EXPECT_NEAR(x + Pitchforks::a(0) * x * x, p.control, 1e-9);
    EXPECT_EQ(p.negative_pivots, x > 1 ? 1 : 0) << p.control;
    unstable += p.negative_pivots;
  }
  EXPECT_GT(unstable, 10);
}

/// Few targets within its reach: not worth one.
TEST(BranchSeries, ServesOnlyWhereItPays) {
  EXPECT_EQ(follow(beam(scene::SceneKernel::LINEAR_REDUCED, 8e-4, 14), true).series, 0);
}

TEST(BranchSeries, WhatHasNoneIsNamed) {
  scene::Scene latch = scene::loadScene(test::sourceDir() + "/config/scenes/bistable_latch.yaml");
  latch.steps = 20;
  const PathResult path = follow(latch, true);
  EXPECT_EQ(path.series, 0);
  EXPECT_FALSE(path.no_series.empty());
}

}  // namespace
}  // namespace snapwing::statics
