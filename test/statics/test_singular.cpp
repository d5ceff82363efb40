// Limit points, bifurcations, snap-back and exact features against closed forms and the exact elastica.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scene/jointed_truss.h"
#include "scene/scene_text.h"
#include "snapwing/statics/features.h"
#include "snapwing/statics/scene_curve.h"
#include "support/paths.h"
#include "truss.h"

namespace snapwing::statics {
namespace {

using testing_scenes::LoadedTruss;
using testing_scenes::Truss;

std::vector<double> steps(double to, int count) {
  std::vector<double> targets;
  for (int k = 0; k <= count; ++k) targets.push_back(to * k / count);
  return targets;
}

/// Slender clamped beam of docs/references.md: h/t = 6, h/l = .02, one material of nu = 0, so that the exact elastica
/// holds.
struct SlenderBeam {
  static constexpr double RISE = 1.6e-3, SPAN = 80e-3, THICKNESS = RISE / 6;
  /// Unit of force EI h/l^3 [N]
  static double unit() { return 5.5e6 * 0.01 * std::pow(THICKNESS, 3) / 12 * RISE / std::pow(SPAN, 3); }
  /// @param imperfection  second cosine, in rises
  static scene::Scene scene(scene::SceneKernel kernel, int cells, double imperfection, double to, int count) {
    scene::Scene scene = scene::loadScene(test::sourceDir() + "/config/scenes/snap_beam.yaml");
    scene::Box half;
    half.low(0) = 0;
    half.high(0) = 0.5 * SPAN;
    scene.bodies[0].material = {5.5e6, 0, 0};
    scene.bodies[0].shape = mpm::makeIntersection(
        {mpm::makeCosineBeam(SPAN, {0.5 * RISE, 0.5 * imperfection * RISE}, THICKNESS), mpm::makeBox(half)});
    scene.kernel = kernel;
    scene.cell_size = THICKNESS / cells;
    scene.to = to * RISE;
    scene.steps = count;
    return scene;
  }
};

SceneCurve trace(const scene::Scene& scene, TraceMethod method) {
  TraceSettings settings;
  settings.method = method;
  return traceScene(scene, *scene::compileScene(scene, 1), settings, {});
}

/// Exact elastica: the perfect beam bifurcates at 713.88 EI h/l^3, d/h = .2024, before its maximum of 892.87.
TEST(Bifurcation, ThePerfectBeamBifurcatesBeforeItsMaximum) {
  const SceneCurve curve =
      trace(SlenderBeam::scene(scene::SceneKernel::QUADRATIC, 2, 0, 0.5, 10), TraceMethod::AUTOMATIC);
  ASSERT_EQ(curve.path.status, solver::SolveStatus::CONVERGED) << curve.path.message;
  ASSERT_EQ(curve.path.singular.size(), 1u);
  const SingularPoint& s = curve.path.singular[0];
  EXPECT_EQ(s.kind, SingularKind::BIFURCATION);
  EXPECT_EQ(s.before, 0);
  EXPECT_EQ(s.after, 1);
  EXPECT_LT(s.load_share, 1e-6);  // the mode breaks the symmetry that the load has
  EXPECT_GT(s.control_rate, 0.5);
  EXPECT_NEAR(s.point.p(0) / SlenderBeam::RISE, 0.2024, 0.02 * 0.2024);
  EXPECT_NEAR(curve.multiplicity * s.point.force() / SlenderBeam::unit(), 713.88, 0.02 * 713.88);
  EXPECT_LT(s.accuracy, 1e-5 * SlenderBeam::RISE);  // the last bracket; the point is its better end
  EXPECT_LT(std::abs(s.eigenvalue), 1e-4);
  EXPECT_FALSE(s.followed);
  // The unstable branch goes on to its maximum.
  double largest = 0;
  for (const PathPoint& p : curve.path.points) largest = std::max(largest, curve.multiplicity * p.force);
  EXPECT_NEAR(largest / SlenderBeam::unit(), 892.87, 0.02 * 892.87);
  EXPECT_EQ(curve.path.points.back().negative_pivots, 1);
}

/// Elastica with an imperfection of 1e-4 h: zero force at d/h = 1.3330, valley -336.09.
TEST(Bifurcation, PerturbationFollowsTheStableBranch) {
  scene::Scene scene = SlenderBeam::scene(scene::SceneKernel::QUADRATIC, 1, 0, 2, 20);
  scene.perturbation = 1e-2 * SlenderBeam::RISE;
  const SceneCurve curve = trace(scene, TraceMethod::AUTOMATIC);
  ASSERT_EQ(curve.path.status, solver::SolveStatus::CONVERGED) << curve.path.message;
  ASSERT_GE(curve.path.singular.size(), 1u);
  EXPECT_TRUE(curve.path.singular[0].followed);
  double largest = 0;
  for (const PathPoint& p : curve.path.points) {
    EXPECT_TRUE(p.stable) << p.control;
    largest = std::max(largest, curve.multiplicity * p.force / SlenderBeam::unit());
  }
  EXPECT_LT(largest, 730);
  const vehicle::CurveFeatures f = vehicle::curveFeatures(curve.table());
  EXPECT_NEAR(f.barrier_travel / SlenderBeam::RISE, 1.3330, 0.01);
  EXPECT_NEAR(f.valley_force / SlenderBeam::unit(), -336.09, 0.1 * 336.09);  // one cell across
}

/// The perfect beam's own branch snaps back in the displacement near d/h = 1.6: no displacement control can follow it.
TEST(Automatic, PassesTheSnapBackThatDisplacementControlCannot) {
  const scene::Scene scene = SlenderBeam::scene(scene::SceneKernel::LINEAR_REDUCED, 1, 0, 2, 20);
  const auto compiled = scene::compileScene(scene, 1);
  AutomaticSettings settings;
  settings.arc_on_failure = false;
  settings.path.refuse_jumps = true;
  settings.path.locate_singular = false;
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(compiled->problem().freeCount());
  const PathResult stuck = followAutomatically(compiled->problem(), rest, steps(scene.to, 20), settings);
  EXPECT_NE(stuck.status, solver::SolveStatus::CONVERGED);
  EXPECT_GT(stuck.halvings, 5);
  EXPECT_NE(stuck.message.find("halved"), std::string::npos) << stuck.message;
  ASSERT_FALSE(stuck.points.empty());
  EXPECT_GT(stuck.points.back().control, 1.4 * SlenderBeam::RISE);
  settings.arc_on_failure = true;
  const PathResult whole = followAutomatically(compiled->problem(), rest, steps(scene.to, 20), settings);
  ASSERT_EQ(whole.status, solver::SolveStatus::CONVERGED) << whole.message;
  EXPECT_EQ(whole.points.back().control, scene.to);
  EXPECT_GE(turningPoints(whole.points).size(), 2u);
  ASSERT_GE(whole.account.size(), 2u);  // what failed, and what passed
  EXPECT_NE(whole.account[0].find("displacement control"), std::string::npos);
  EXPECT_NE(whole.account[1].find("arc length"), std::string::npos);
}

TEST(Automatic, TrussOnASoftSpring) {
  const Truss truss(0.25, 1e-2);
  AutomaticSettings settings;
  settings.arc_on_failure = false;
  settings.path.refuse_jumps = true;
  const PathResult stuck = followAutomatically(truss, Eigen::VectorXd::Zero(1), steps(1.2, 60), settings);
  EXPECT_NE(stuck.status, solver::SolveStatus::CONVERGED);
  EXPECT_LT(stuck.points.back().control, 0.7);
  settings.arc_on_failure = true;
  const PathResult whole = followAutomatically(truss, Eigen::VectorXd::Zero(1), steps(1.2, 60), settings);
  ASSERT_EQ(whole.status, solver::SolveStatus::CONVERGED) << whole.message;
  for (const PathPoint& p : whole.points) EXPECT_NEAR(p.force, truss.apexForce(p.solution(0)), 1e-9);
  ASSERT_EQ(whole.singular.size(), 2u);
  for (const SingularPoint& s : whole.singular) {
    EXPECT_EQ(s.kind, SingularKind::LIMIT_POINT);
    EXPECT_GT(s.load_share, 0.99);
    // The control turns where the truss is as soft as the spring is stiff.
    solver::Evaluation at;
    truss.evaluate(s.point.z, s.point.p, solver::Order::TANGENT, at);
    EXPECT_NEAR(at.hessian[0], 0, 1e-8);
  }
  EXPECT_EQ(turningPoints(whole.points).size(), 2u);
}

TEST(Automatic, WithoutSupportNothingIsFollowed) {
  scene::Scene scene = scene::testing_scenes::jointedTruss(2, "linear", 1);
  scene.pins.clear();
  const SceneCurve curve = trace(scene, TraceMethod::AUTOMATIC);
  EXPECT_EQ(curve.path.status, solver::SolveStatus::SINGULAR);
}

TEST(Singular, LimitLoadOfTheTrussIsExact) {
  const LoadedTruss truss(0.25);
  ArcSettings settings;
  settings.first_step = 2e-4;
  settings.largest_step = 5e-4;
  settings.end = 8e-3;
  const ArcResult arc = followArc(truss, Eigen::VectorXd::Zero(1), 0, settings);
  ASSERT_EQ(arc.path.singular.size(), 2u);
  const double limit = 5.4912944e-3, apex = 0.25 - 0.25 / std::sqrt(3.0);
  for (const int k : {0, 1}) {
    const SingularPoint& s = arc.path.singular[k];
    EXPECT_EQ(s.kind, SingularKind::LIMIT_POINT);
    EXPECT_NEAR(s.point.p(0), k == 0 ? limit : -limit, 1e-10);
    EXPECT_NEAR(s.point.z(0), k == 0 ? apex : 0.5 - apex, 1e-6);
  }
}

/// Peak, valley and zeros of the truss are solved for: far finer than the points' spacing.
TEST(Features, AreExactOnTheTruss) {
  const Truss truss(0.25, 100);
  const PathResult path = PathFollower(truss, {}).follow(Eigen::VectorXd::Zero(1), steps(0.55, 22));
  ASSERT_EQ(path.status, solver::SolveStatus::CONVERGED);
  solver::NewtonSettings newton;
  newton.relative_tolerance = 1e-11;
  solver::EquilibriumSolver solver(truss, newton);
  const std::vector<Feature> found = locateFeatures(solver, path.points);
  ASSERT_EQ(found.size(), 5u);  // start, peak, flat, valley, second state
  const FeatureKind kinds[] = {FeatureKind::ZERO, FeatureKind::PEAK, FeatureKind::ZERO, FeatureKind::VALLEY,
                               FeatureKind::ZERO};
  const double apex = 0.25 / std::sqrt(3.0), load = truss.apexForce(0.25 - apex);
  const double forces[] = {0, load, 0, -load, 0};
  const double moves[] = {0, 0.25 - apex, 0.25, 0.25 + apex, 0.5};
  EXPECT_NEAR(load, 5.4912944e-3, 1e-10);
  for (int k = 0; k < 5; ++k) {
    EXPECT_EQ(found[k].kind, kinds[k]) << k;
    EXPECT_NEAR(found[k].point.force, forces[k], 1e-12) << k;
    EXPECT_NEAR(found[k].point.control, moves[k] + forces[k] / 100, 1e-9) << k;
    EXPECT_LT(found[k].accuracy, 1e-9) << k;
  }
}

/// Towards negative travel, and on the way back, the same features: a peak resists whatever leaves 0.
TEST(Features, DoNotDependOnTheDirection) {
  for (const double sign : {1.0, -1.0}) {
    const Truss truss(sign * 0.25, 100);
    std::vector<double> way = steps(0.55, 22);
    for (double& u : way) u *= sign;
    PathResult path = PathFollower(truss, {}).follow(Eigen::VectorXd::Zero(1), way);
    ASSERT_EQ(path.status, solver::SolveStatus::CONVERGED);
    for (const bool back : {false, true}) {
      if (back) std::reverse(path.points.begin(), path.points.end());
      int lost = -1;
      solver::EquilibriumSolver solver(truss, {});
      std::vector<Feature> found = locateFeatures(solver, path.points, &lost);
      if (back) std::reverse(found.begin(), found.end());
      ASSERT_EQ(found.size(), 5u);
      EXPECT_EQ(lost, 0);
      EXPECT_EQ(found[1].kind, FeatureKind::PEAK) << sign << back;
      EXPECT_EQ(found[3].kind, FeatureKind::VALLEY) << sign << back;
      EXPECT_GT(sign * found[1].point.force, 5e-3);
    }
  }
}

/// On a solid, the located points agree with those of a path ten times finer.
TEST(Features, DoNotDependOnThePath) {
  scene::Scene scene = scene::loadScene(test::sourceDir() + "/config/scenes/snap_beam.yaml");
  scene.kernel = scene::SceneKernel::LINEAR_REDUCED;
  scene.cell_size = 8e-4;
  std::vector<std::vector<Feature>> found;
  for (const int count : {28, 140}) {
    scene.steps = count;
    const auto compiled = scene::compileScene(scene, 1);
    const SceneCurve curve = traceScene(scene, *compiled, {}, {});
    solver::NewtonSettings newton;
    newton.relative_tolerance = 1e-12;
    solver::EquilibriumSolver solver(compiled->problem(), newton);
    found.push_back(locateFeatures(solver, curve.path.points));
  }
  ASSERT_EQ(found[0].size(), 5u);
  ASSERT_EQ(found[1].size(), 5u);
  for (int k = 1; k < 5; ++k) {
    EXPECT_EQ(found[0][k].kind, found[1][k].kind);
    EXPECT_NEAR(found[0][k].point.control, found[1][k].point.control, 1e-9) << k;  // of 20 mm
    EXPECT_NEAR(found[0][k].point.force, found[1][k].point.force, 1e-8) << k;
  }
}

/// No equilibrium has the far end of a bar beyond its held one: a path that is asked there ends with a reason.
TEST(SceneCurve, ImpossibleTravelIsReportedNotInvented) {
  const SceneCurve curve = scene::trace(scene::sceneFromText(
      "scene: bar\nlength_unit: mm\ndimension: 2\nplane: strain\nkernel: linear_reduced\ncell_size: 0.5\n"
      "bodies:\n  bar:\n    material: {youngs_modulus: 5.5e+6, poisson_ratio: 0.48}\n    thickness: 1\n"
      "    shape: {box: {x: [0, 8], y: [0, 2]}}\n"
      "supports: [{name: left, body: bar, region: {x: [0, 0]}, hold: xy}]\n"
      "ports: [{name: right, body: bar, region: {x: [8, 8]}, direction: [-1, 0], cross_motion: held}]\n"
      "path: {to: 9, steps: 9}\n"));
  EXPECT_NE(curve.path.status, solver::SolveStatus::CONVERGED);
  EXPECT_FALSE(curve.path.message.empty());
  ASSERT_GT(curve.path.points.size(), 3u) << "what is possible is there";
  for (const PathPoint& p : curve.path.points) {
    EXPECT_LT(p.control, 8e-3);
    EXPECT_GT(p.min_det_f, 0);
    EXPECT_TRUE(std::isfinite(p.force));
  }
}

}  // namespace
}  // namespace snapwing::statics
