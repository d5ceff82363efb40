// Inertia of what follows a control: closed forms, differences along a path, the same by scene, symmetry and arm.
#include <gtest/gtest.h>

#include <cmath>

#include "scene/scene_text.h"
#include "snapwing/elasticity/neo_hookean.h"
#include "snapwing/scene/arm_scene.h"
#include "support/example_arm.h"

namespace snapwing::statics {
namespace {

TEST(MovingMass, TranslationAndRotationOfABlockAreInClosedForm) {
  mpm::Discretisation<2> solid;
  mpm::Grid<2> grid;
  grid.cell_size = 0.01;
  grid.cells = {4, 2};
  const int model = solid.addModel(std::make_shared<elasticity::NeoHookean<2>>(elasticity::Material{1e6, 0.3, 0},
                                                                               elasticity::DensityInterpolation{}));
  const int kind = solid.addKind({{solid.addRule(mpm::gaussRule<2>(grid, 1)), model},
                                  {solid.addRule(mpm::gaussRule<2>(grid, 2)), model}});  // two parts of one material
  solid.addBody(grid);
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 2; ++j) solid.addCell({i, j}, {kind, 0.5, 0.01 * 0.01 * 0.003});
  }
  solid.finish();
  const double mass = 0.5 * 1200 * 0.04 * 0.02 * 0.003;
  Eigen::VectorXd shift(solid.dofCount()), turn(solid.dofCount());
  for (int node = 0; node < solid.nodeCount(); ++node) {
    const mpm::Vector<2> arm = solid.position(node) - mpm::Vector<2>(0.02, 0.01);
    shift.segment<2>(2 * node) << 0.6, -0.8;
    turn.segment<2>(2 * node) << -arm(1), arm(0);
  }
  const mpm::MovingMass moved = mpm::movingMass<2>(solid, {1200}, shift, {0, 1});
  EXPECT_NEAR(moved.mass, mass, 1e-15);
  EXPECT_NEAR(moved.kinetic, mass, 1e-15);
  EXPECT_NEAR(moved.coupled, -0.8 * mass, 1e-15);
  const mpm::MovingMass turned = mpm::movingMass<2>(solid, {1200}, turn, {0, 1});
  EXPECT_NEAR(turned.kinetic, mass * (0.04 * 0.04 + 0.02 * 0.02) / 12, 1e-18);
  EXPECT_NEAR(turned.coupled, 0, 1e-18);
}

scene::Scene coarseArm(scene::ArmSceneSettings settings) {
  const mpm::DensityField design =
      mpm::loadDensityCsv(test::sourceDir() + "/data/arms/arris_x220_study.csv", 0.08, 0.04);
  settings.cell_size = 0.002;
  return scene::armScene(testing::exampleArmVehicle(), design, settings);
}

/// K and S of the tangent against those of differences of solved equilibria, which must close in as their square.
TEST(MovingMass, IsThatOfDifferencesAlongTheArmsPath) {
  const auto arm = scene::compileScene(coarseArm({}), 1);
  const auto error = [&](double u, double h) {
    std::vector<double> targets;
    for (double at = 0; at < u - 0.002; at += 0.002) targets.push_back(at);
    for (const double at : {u - h, u, u + h}) targets.push_back(at);
    const PathResult path =
        PathFollower(arm->problem(), {}).follow(Eigen::VectorXd::Zero(arm->problem().freeCount()), targets);
    EXPECT_EQ(path.status, solver::SolveStatus::CONVERGED);
    const std::size_t n = path.points.size();
    const Eigen::VectorXd rate = (path.points[n - 1].solution - path.points[n - 3].solution) / (2 * h);
    const PathPoint& middle = path.points[n - 2];
    const mpm::MovingMass by_tangent = arm->movingMass(middle.solution, middle.control, middle.slope),
                          by_difference = arm->movingMass(middle.solution, middle.control, rate);
    EXPECT_LT(by_tangent.coupled, -0.15 * by_tangent.mass);
    EXPECT_LE(by_tangent.coupled * by_tangent.coupled, by_tangent.mass * by_tangent.kinetic);
    return std::max(std::abs(by_tangent.kinetic - by_difference.kinetic),
                    std::abs(by_tangent.coupled - by_difference.coupled)) /
           by_tangent.mass;
  };
  for (const double u : {0.010, 0.030, 0.055}) {
    const double coarse = error(u, 4e-4), fine = error(u, 1e-4);
    EXPECT_LT(fine, 1e-4) << u;
    EXPECT_NEAR(coarse / fine, 16, 3) << u;
  }
}

TEST(MovingMass, RidesWithTheCentreMostAtThePeak) {
  scene::ArmSceneSettings settings;
  settings.from = -0.004;
  settings.to = 0.056;
  settings.step = 0.002;
  settings.back = false;
  const SceneCurve curve = scene::trace(coarseArm(settings));
  ASSERT_EQ(curve.costs().status, solver::SolveStatus::CONVERGED) << curve.costs().message;
  const vehicle::ForceTable t = curve.table();
  EXPECT_NO_THROW(t.validate());
  EXPECT_EQ(t.kinetic_mass.size(), t.travel.size());
  const auto share = [&](double u) {
    for (std::size_t k = 0; k < t.travel.size(); ++k) {
      if (std::abs(t.travel[k] - u) < 1e-9) return -t.coupled_mass[k] / t.mass;
    }
    return std::nan("");
  };
  EXPECT_GT(share(0.010), share(0.0));
  EXPECT_GT(share(0.0), share(0.052));
  EXPECT_GT(share(0.052), 0.1);
  EXPECT_LT(share(0.010), 1.05);
}

TEST(MovingMass, OfASceneIsThatOfTheWholeWhateverSymmetryIsUsed) {
  const auto press = [](const std::string& use) {
    return "scene: press\nlength_unit: mm\ndimension: 3\nkernel: linear_reduced\ncell_size: 1\nuse_symmetry: " + use +
           "\nbodies:\n  block:\n    material: {youngs_modulus: 5.5e+6, poisson_ratio: 0.48, mass_density: 1210}\n"
           "    shape: {box: {x: [2, 6], y: [0, 2], z: [0, 2]}}\n"
           "supports:\n  - {name: table, region: {y: [0, 0]}, hold: y}\n"
           "  - {name: rail, region: {y: [0, 0], x: [4, 4]}, hold: x}\n"
           "  - {name: edge, region: {y: [0, 0], z: [1, 1]}, hold: z}\n"
           "ports:\n  - {name: ram, region: {y: [2, 2]}, direction: [0, -1, 0], cross_motion: free}\n"
           "path: {to: 0.2, steps: 4}\n";
  };
  const SceneCurve whole = scene::trace(scene::sceneFromText(press("false"))),
                   quarter = scene::trace(scene::sceneFromText(press("all")));
  ASSERT_EQ(whole.path.status, solver::SolveStatus::CONVERGED) << whole.path.message;
  ASSERT_EQ(quarter.multiplicity, 4);
  const double mass = 1210 * 16e-9;
  for (std::size_t k = 0; k < whole.inertia.size(); ++k) {
    EXPECT_NEAR(whole.inertia[k].mass, mass, 1e-12 * mass);
    EXPECT_NEAR(quarter.inertia[k].mass, mass, 1e-12 * mass);
    EXPECT_NEAR(quarter.inertia[k].kinetic, whole.inertia[k].kinetic, 1e-6 * mass);
    // Compressed evenly, particles follow the ram in proportion to their height: half of the mass in the mean.
    EXPECT_NEAR(whole.inertia[k].coupled, -0.5 * mass, 1e-6 * mass);
    EXPECT_NEAR(quarter.inertia[k].coupled, -0.5 * mass, 1e-6 * mass);
  }
  const vehicle::ForceTable table = whole.table();
  EXPECT_NO_THROW(table.validate());
  EXPECT_NEAR(table.coupled_mass.back(), -0.5 * mass, 1e-6 * mass);
}

}  // namespace
}  // namespace snapwing::statics
