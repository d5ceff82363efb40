// Ports and joints three ways: elimination, augmented Lagrangian, multipliers. All must give the same curve, and the
// reaction must be the derivative of the energy by the travel.
#include <gtest/gtest.h>

#include <cmath>

#include "scene/jointed_truss.h"
#include "snapwing/statics/scene_curve.h"
#include "support/derivative_check.h"
#include "support/paths.h"

namespace snapwing::statics {
namespace {

const std::string SCENES = test::sourceDir() + "/config/scenes/";

struct Case {
  const char* name;
  int dimension;
  bool joint;
  double near, far;  ///< [m] travel in the first and in the second basin
};

scene::Scene sceneOf(const Case& c) {
  if (c.joint)
    return scene::testing_scenes::jointedTruss(c.dimension, c.dimension == 2 ? "quadratic" : "linear_reduced", 1.0);
  scene::Scene scene = scene::loadScene(SCENES + (c.dimension == 2 ? "snap_beam.yaml" : "arm_volumetric.yaml"));
  scene.cell_size = c.dimension == 2 ? 8e-4 : 5e-3;
  return scene;
}

PathResult trace(const scene::CompiledScene& compiled, double to, int steps) {
  PathSettings settings;
  settings.newton.relative_tolerance = 1e-12;
  std::vector<double> targets;
  for (int k = 0; k <= steps; ++k) targets.push_back(to * k / steps);
  return PathFollower(compiled.problem(), settings)
      .follow(Eigen::VectorXd::Zero(compiled.problem().freeCount()), targets);
}

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class Enforcements : public ::testing::TestWithParam<Case> {};

TEST_P(Enforcements, AgreeWithEachOtherAndWithTheEnergy) {
  const Case& c = GetParam();
  scene::Scene scene = sceneOf(c);
  std::vector<PathResult> paths;
  for (const solver::Enforcement enforcement :
       {solver::Enforcement::ELIMINATION, solver::Enforcement::AUGMENTED_LAGRANGIAN,
        solver::Enforcement::MULTIPLIERS}) {
    scene.enforcement = enforcement;
    const auto compiled = scene::compileScene(scene, 1);
    EXPECT_EQ(compiled->problem().constraints() != nullptr, enforcement != solver::Enforcement::ELIMINATION);
    paths.push_back(trace(*compiled, c.far, 20));
    ASSERT_EQ(paths.back().status, solver::SolveStatus::CONVERGED)
        << solver::enforcementName(enforcement) << ": " << paths.back().message;
  }
  double largest = 0;
  bool second_basin = false;
  for (const PathPoint& p : paths[0].points) {
    largest = std::max(largest, std::abs(p.force));
    second_basin = second_basin || p.force < 0;
  }
  EXPECT_TRUE(second_basin) << "the path does not reach the second basin";
  for (const std::size_t other : {1u, 2u}) {
    for (std::size_t k = 0; k < paths[0].points.size(); ++k) {
      const PathPoint &a = paths[0].points[k], &b = paths[other].points[k];
      // Constraints close to 1e-10 of a cell, and residuals to 1e-12 of the cells' forces.
      EXPECT_NEAR(a.force, b.force, 1e-7 * largest) << "at " << a.control;
      EXPECT_NEAR(a.stiffness, b.stiffness, 1e-6 * std::abs(paths[0].points[0].stiffness)) << "at " << a.control;
      EXPECT_NEAR(a.energy, b.energy, 1e-8 * largest * c.far) << "at " << a.control;
      EXPECT_EQ(a.negative_pivots, b.negative_pivots) << "at " << a.control;
    }
  }
}

TEST_P(Enforcements, TheReactionIsTheSlopeOfTheEnergy) {
  const Case& c = GetParam();
  scene::Scene scene = sceneOf(c);
  for (const solver::Enforcement enforcement :
       {solver::Enforcement::ELIMINATION, solver::Enforcement::AUGMENTED_LAGRANGIAN,
        solver::Enforcement::MULTIPLIERS}) {
    scene.enforcement = enforcement;
    const auto compiled = scene::compileScene(scene, 1);
    solver::NewtonSettings newton;
    newton.relative_tolerance = 1e-11;  // displacements of 17 mm on .4 mm cells round to 4e-11 N
    solver::EquilibriumSolver solver(compiled->problem(), newton);
    for (const double travel : {c.near, c.far}) {
      const PathResult path = trace(*compiled, travel, 20);
      ASSERT_EQ(path.status, solver::SolveStatus::CONVERGED) << path.message;
      solver::Equilibrium x = solver.start(path.points.back().solution, travel);
      x.multipliers = path.points.back().multipliers;
      ASSERT_TRUE(solver.minimise(x).converged());
      solver.linearise(x);
      const auto energy = [&](double h) {
        solver::Equilibrium moved = solver.predict(x, travel + h);
        const solver::NewtonResult result = solver.minimise(moved);
        EXPECT_TRUE(result.converged()) << result.message;
        return Eigen::VectorXd::Constant(1, moved.at.elastic_energy);
      };
      EXPECT_TRUE(
          snapwing::test::derivativeMatches(energy, Eigen::VectorXd::Constant(1, x.force()), 0.2 * c.near, 1e-6))
          << solver::enforcementName(enforcement) << " at " << travel;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Enforcements,
                         ::testing::Values(Case{"beam", 2, false, 1e-3, 17e-3},
                                           Case{"solid_arm", 3, false, 5e-3, 50e-3},
                                           Case{"truss", 2, true, 1e-3, 8.5e-3},
                                           Case{"solid_truss", 3, true, 1e-3, 8.5e-3}),
                         [](const auto& instance) { return instance.param.name; });

/// A joint whose bodies are driven by the same rigid plate says nothing new, whatever way it is imposed.
TEST(Enforcement, AJointAtADrivenPortIsDropped) {
  for (const solver::Enforcement enforcement :
       {solver::Enforcement::ELIMINATION, solver::Enforcement::AUGMENTED_LAGRANGIAN,
        solver::Enforcement::MULTIPLIERS}) {
    scene::Scene scene = scene::testing_scenes::jointedTruss(2, "linear", 1.0);
    scene::ScenePort other = scene.ports[0];
    other.body = 1;
    other.region.low(0) = other.region.high(0) = -1e-3;
    scene.ports.push_back(other);
    scene.ports[0].region.low(0) = scene.ports[0].region.high(0) = -1e-3;
    scene.joints[0].x = -1e-3;
    scene.enforcement = enforcement;
    scene.to = 2e-3;
    scene.steps = 4;
    const auto compiled = scene::compileScene(scene, 1);
    const PathResult path = trace(*compiled, scene.to, 4);
    ASSERT_EQ(path.status, solver::SolveStatus::CONVERGED)
        << solver::enforcementName(enforcement) << ": " << path.message;
    static double first = path.points.back().force;
    EXPECT_NEAR(path.points.back().force, first, 1e-8 * std::abs(first)) << solver::enforcementName(enforcement);
  }
}

TEST(Enforcement, NamesAreReadBack) {
  for (const solver::Enforcement enforcement :
       {solver::Enforcement::ELIMINATION, solver::Enforcement::AUGMENTED_LAGRANGIAN,
        solver::Enforcement::MULTIPLIERS}) {
    EXPECT_EQ(solver::enforcementFromName(solver::enforcementName(enforcement)), enforcement);
  }
  EXPECT_ANY_THROW(solver::enforcementFromName("glue"));
}

}  // namespace
}  // namespace snapwing::statics
