// Loads on the surfaces of bodies, weight that follows the densities, volume of what cells cut: against closed forms of
// bars (E = 1 MPa, nu = 0, 20 x 4 x 5 mm) and against the same scene compiled anew.
#include <gtest/gtest.h>

#include <cmath>

#include "scene_text.h"
#include "snapwing/common/error.h"
#include "support/derivative_check.h"

namespace snapwing::scene {
namespace {

/// @param rest  thickness and shape of the one body, then the lists
std::string bar(int dimension, double cell_size, const std::string& body, const std::string& lists) {
  return "scene: bar\nlength_unit: mm\ndimension: " + std::to_string(dimension) +
         (dimension == 2 ? "\nplane: stress" : "") + "\nkernel: linear\ncell_size: " + std::to_string(cell_size) +
         "\nbodies:\n  bar:\n    material: {youngs_modulus: 1.0e+6, poisson_ratio: 0.0, mass_density: 1000}\n" + body +
         lists;
}

const char* const PULLED_2 =
    "supports:\n  - {name: left, region: {x: [0, 0]}, hold: xy}\n"
    "ports:\n  - {name: right, region: {x: [20, 20]}, direction: [1, 0], cross_motion: free}\n"
    "path: {to: 0.02, steps: 1}\n";
const char* const PULLED_3 =
    "supports:\n  - {name: left, region: {x: [0, 0]}, hold: xyz}\n"
    "ports:\n  - {name: right, region: {x: [20, 20]}, direction: [1, 0, 0], cross_motion: free}\n"
    "path: {to: 0.02, steps: 1}\n";

const char* const STEPPED =
    "    thickness: 5\n    shape:\n      union:\n        - box: {x: [0, 10], y: [0, 4]}\n"
    "        - box: {x: [0, 4], y: [0, 8]}\n";
std::string pressed(const std::string& region, const std::string& force) {
  return "supports:\n  - {name: floor, region: {y: [0, 0]}, hold: xy}\nloads:\n  - {name: step, region: " + region +
         ", force: " + force +
         "}\nmonitors:\n  - {name: step, at: [8, 4], direction: [0, 1]}\npath: {to: 1, steps: 1}\n";
}

/// The plane y = 4 is the upper face of the step and lies inside of the tower, which must not be loaded. A column of
/// 4 mm under .03 N on 6 x 5 mm is shortened by 4.0e-6 m; the tower holds it back a little.
TEST(SceneLoads, ActOnTheSurfaceWhereverItIs) {
  const double all = trace(sceneFromText(bar(2, 1, STEPPED, pressed("{y: [4, 4]}", "[0, -0.03]")))).monitors[1][0];
  const double named =
      trace(sceneFromText(bar(2, 1, STEPPED, pressed("{x: [4, 10], y: [4, 4]}", "[0, -0.03]")))).monitors[1][0];
  EXPECT_NEAR(all, -4.0e-6, 0.5e-6);
  EXPECT_NEAR(all, named, 1e-12);
  EXPECT_NE(reasonFor(bar(2, 1, STEPPED, pressed("{x: [0, 4], y: [4, 4]}", "[0, -0.03]"))).find("meets no surface"),
            std::string::npos);
  EXPECT_NE(reasonFor(bar(2, 1, STEPPED, pressed("{y: [9, 9]}", "[0, -0.03]"))).find("meets no material"),
            std::string::npos);
}

/// An end face towards +x in the middle of the grid, on a face between cells and within cells, in plane and space.
TEST(SceneLoads, ActOnEndFacesWithinTheGrid) {
  for (const int dimension : {2, 3}) {
    for (const double cell_size : {1.0, 0.8}) {
      const std::string zero = dimension == 3 ? ", 0" : "";
      const std::string body =
          "    thickness: 4\n    shape:\n      union:\n        - box: {x: [0, 20], y: [0, 4]}\n"
          "        - box: {x: [0, 10], y: [4, 8]}\n";
      const std::string lists = "supports:\n  - {name: left, region: {x: [0, 0]}, hold: xy" +
                                std::string(dimension == 3 ? "z" : "") +
                                "}\nloads:\n  - {name: end, region: {x: [10, 10]}, force: [0.02, 0" + zero +
                                "]}\nmonitors:\n  - {name: end, at: [10, 6" + zero + "], direction: [1, 0" + zero +
                                "]}\npath: {to: 1, steps: 1}\n";
      // 10 mm of 8 x 4 mm under .02 N: 6.25e-6 m in the mean, more above, where the load acts.
      const double moved = trace(sceneFromText(bar(dimension, cell_size, body, lists))).monitors[1][0];
      EXPECT_GT(moved, 6.25e-6) << dimension << "-D, " << cell_size << " mm";
      EXPECT_LT(moved, 2 * 6.25e-6) << dimension << "-D, " << cell_size << " mm";
    }
  }
}

/// One traction stretches a thin and a thick half alike: .04 N on 2 x 5 + 2 x 15 mm2 is 1 kPa, 2.0e-5 m over 20 mm.
TEST(SceneLoads, TractionCountsTheThickness) {
  for (const int dimension : {2, 3}) {
    const std::string zero = dimension == 3 ? ", 0" : "";
    const std::string lists =
        "supports:\n  - {name: left, region: {x: [0, 0]}, hold: xy" + std::string(dimension == 3 ? "z" : "") +
        "}\nloads:\n  - {name: end, region: {x: [20, 20]}, force: [0.04, 0" + zero +
        "]}\nmonitors:\n  - {name: thin, at: [20, 1" + zero + "], direction: [1, 0" + zero +
        "]}\n  - {name: thick, at: [20, 3" + zero + "], direction: [1, 0" + zero + "]}\npath: {to: 1, steps: 1}\n";
    const statics::SceneCurve curve =
        trace(sceneFromText(bar(dimension, 1,
                                "    thickness: 5\n    thickness_in: [{region: {y: [2, 4]}, thickness: 15}]\n"
                                "    shape: {box: {x: [0, 20], y: [0, 4]}}\n",
                                lists)));
    EXPECT_NEAR(curve.monitors[1][0], 2.0e-5, 0.01e-5) << dimension << "-D";
    EXPECT_NEAR(curve.monitors[1][1], 2.0e-5, 0.01e-5) << dimension << "-D";
  }
}

/// 5 mm in cells of 2 mm and 3.3 mm in cells of 1 mm: the weights of the samples are those of the exact share.
TEST(SceneVolume, CutBoxesHaveTheirVolume) {
  const Scene thin =
      sceneFromText(bar(3, 2, "    thickness: 5\n    shape: {box: {x: [0, 20], y: [0, 4]}}\n", PULLED_3));
  EXPECT_NEAR(trace(thin).path.points.back().force, 0.01999, 2e-6);
  EXPECT_NEAR(compileScene(thin, 1)->volume().modelled, 400e-9, 1e-15);
  for (const int dimension : {2, 3}) {
    const Scene scene =
        sceneFromText(bar(dimension, 1, "    thickness: 5\n    shape: {box: {x: [0, 20], y: [0, 3.3]}}\n",
                          dimension == 2 ? PULLED_2 : PULLED_3));
    const auto compiled = compileScene(scene, 1);
    EXPECT_NEAR(compiled->volume().modelled, 330e-9, 1e-14);
    EXPECT_NEAR(compiled->volume().bodies, 330e-9, 0.002 * 330e-9);
    EXPECT_NEAR(trace(scene).path.points.back().force, 0.01999 * 3.3 / 4, 2e-6) << dimension << "-D";
  }
}

/// What is not corrected is said: a disc of 3 mm radius on cells of 2 mm with one sample per axis.
TEST(SceneVolume, ErrorOfOtherShapesIsStated) {
  const Scene scene = sceneFromText(bar(2, 2, "    thickness: 5\n    shape: {disc: {centre: [0, 0], radius: 3}}\n",
                                        "particles: 1\nsupports:\n  - {name: low, region: {y: [-3, -2]}, hold: xy}\n"
                                        "ports:\n  - {name: top, region: {y: [1, 3]}, direction: [0, 1], cross_motion: "
                                        "held}\npath: {to: 0.01, steps: 1}\n"));
  const SceneVolume volume = compileScene(scene, 1)->volume();
  EXPECT_NEAR(volume.bodies, M_PI * 9e-6 * 5e-3, 0.003 * M_PI * 9e-6 * 5e-3);
  EXPECT_NEAR(volume.modelled, 9 * 4e-6 * 5e-3, 1e-15) << "nine cells whose middle lies in the disc";
}

/// A column held at its foot and pushed by a port, heavy, at densities of .5 .. 1.
std::string heavyColumn(int dimension) {
  const std::string zero = dimension == 3 ? ", 0" : "";
  return bar(dimension, 1, "    thickness: 2\n    shape: {box: {x: [0, 3], y: [0, 4]}}\n",
             "gravity: [3.0e+3, -1.0e+4" + zero + "]\nsupports:\n  - {name: foot, region: {y: [0, 0]}, hold: xy" +
                 std::string(dimension == 3 ? "z" : "") +
                 "}\nports:\n  - {name: push, region: {x: [3, 3], y: [2, 4]}, direction: [1, 0" + zero +
                 "], cross_motion: free}\nmonitors:\n  - {name: top, at: [1, 4" + zero + "], direction: [0, 1" + zero +
                 "]}\npath: {to: 0.3, steps: 2}\n");
}

std::vector<double> densities(int cells, double h) {
  std::vector<double> rho(cells);
  for (int c = 0; c < cells; ++c) rho[c] = 0.75 + 0.2 * std::sin(5.0 * c) + h * std::cos(3.0 * c);
  return rho;
}

solver::NewtonSettings tight() {
  solver::NewtonSettings newton;
  newton.relative_tolerance = 1e-12;
  return newton;
}

solver::Equilibrium solved(const CompiledScene& compiled) {
  statics::PathSettings settings;
  settings.newton = tight();
  statics::PathFollower follower(compiled.problem(), settings);
  const statics::PathResult path =
      follower.follow(Eigen::VectorXd::Zero(compiled.problem().freeCount()), {0, 1.5e-4, 3e-4});
  EXPECT_EQ(path.status, solver::SolveStatus::CONVERGED) << path.message;
  return follower.place();
}

/// Densities that are set later weigh what those of the file would: the same bits.
TEST(SceneWeight, FollowsTheDensities) {
  const Scene scene = sceneFromText(heavyColumn(2));
  const auto once = compileScene(scene, 1), again = compileScene(scene, 1);
  const double heavy = solved(*once).at.energy;
  once->setDensities(std::vector<double>(once->cellCount(), 0.5));
  once->setDensities(densities(once->cellCount(), 0));
  again->setDensities(densities(again->cellCount(), 0));
  const solver::Equilibrium a = solved(*once), b = solved(*again);
  EXPECT_EQ(a.at.energy, b.at.energy);
  EXPECT_NE(a.at.energy, heavy);
  // The weight itself: energy less elastic energy is -sum rho m g . u, here by the forces at the foot.
  std::string light = heavyColumn(2);
  light.replace(light.find("mass_density: 1000"), 18, "mass_density: 500.0");
  const auto half_mass = compileScene(sceneFromText(light), 1);
  const auto half_density = compileScene(scene, 1);
  half_mass->setDensities(std::vector<double>(half_mass->cellCount(), 1.0));
  half_density->setDensities(std::vector<double>(half_density->cellCount(), 0.5));
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(half_mass->problem().freeCount()), p = Eigen::VectorXd::Zero(1);
  solver::Evaluation at_mass, at_density;
  half_mass->problem().evaluate(rest, p, solver::Order::STRESS, at_mass);
  half_density->problem().evaluate(rest, p, solver::Order::STRESS, at_density);
  EXPECT_GT(at_mass.residual.norm(), 1e-3) << "no weight";
  EXPECT_LT((at_mass.residual - at_density.residual).norm(), 1e-12 * at_mass.residual.norm());
}

/// The same densities set later, and told by the scene itself.
TEST(SceneWeight, NewDensitiesAreThoseOfACompilationAnew) {
  const Scene scene = sceneFromText(heavyColumn(2));
  const auto later = compileScene(scene, 1);
  const std::vector<double> rho = densities(later->cellCount(), 0);
  later->setDensities(rho);
  const mpm::Discretisation<2>& solid = *later->planar();
  Scene told = scene;
  mpm::DensityField field;
  field.cell_size = solid.grid(0).cell_size;
  field.cells = {solid.grid(0).cells[0], solid.grid(0).cells[1]};
  for (int j = 0; j < field.cells[1]; ++j) {
    for (int i = 0; i < field.cells[0]; ++i) {
      const int cell = solid.findCell(0, {i, j});
      field.value.push_back(cell < 0 ? -1 : rho[cell]);
    }
  }
  told.bodies[0].shape = nullptr;
  told.bodies[0].density = field;
  const auto anew = compileScene(told, 1);
  ASSERT_EQ(anew->cellCount(), later->cellCount());
  const solver::Equilibrium a = solved(*later), b = solved(*anew);
  EXPECT_NEAR(a.at.energy, b.at.energy, 1e-12 * std::abs(a.at.energy));
  EXPECT_NEAR(a.force(), b.force(), 1e-12 * std::abs(a.force()));
  const Eigen::VectorXd one = later->sensitivity(a)->reaction().density,
                        other = anew->sensitivity(b)->reaction().density;
  EXPECT_LT((one - other).norm(), 1e-10 * one.norm());
}

TEST(SceneWeight, ItsSensitivityMatchesDifferences) {
  for (const int dimension : {2, 3}) {
    const Scene scene = sceneFromText(heavyColumn(dimension));
    const auto compiled = compileScene(scene, 1);
    const auto at = [&](double h) {
      compiled->setDensities(densities(compiled->cellCount(), h));
      return solved(*compiled);
    };
    const solver::Equilibrium rest = at(0);
    const auto sensitivity = compiled->sensitivity(rest);
    const SceneSlope slopes[] = {sensitivity->reaction(), sensitivity->potential(), sensitivity->monitor(0),
                                 sensitivity->compliance()};
    const char* const names[] = {"reaction", "potential", "monitor", "compliance"};
    const auto results = [&](double h) {
      const solver::Equilibrium x = at(h);
      return Eigen::Vector4d(x.force(), x.at.energy, compiled->monitors(x.z, x.p(0))[0],
                             x.at.elastic_energy - x.at.energy);
    };
    for (int row = 0; row < 4; ++row) {
      double expected = 0;
      for (int c = 0; c < slopes[row].density.size(); ++c) expected += slopes[row].density(c) * std::cos(3.0 * c);
      EXPECT_TRUE(
          snapwing::test::derivativeMatches([&](double h) { return Eigen::VectorXd::Constant(1, results(h)(row)); },
                                            Eigen::VectorXd::Constant(1, expected), 0.5, 1e-6))
          << names[row] << ", " << dimension << "-D";
    }
  }
}

}  // namespace
}  // namespace snapwing::scene
