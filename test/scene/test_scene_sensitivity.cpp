// Adjoint derivatives of scenes against central differences of solved equilibria: by densities and by joint places, at
// large strain in both basins, in the plane and in space.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "jointed_truss.h"
#include "scene_text.h"
#include "snapwing/common/error.h"
#include "support/derivative_check.h"

namespace snapwing::scene {
namespace {

solver::NewtonSettings tight() {
  solver::NewtonSettings newton;
  newton.relative_tolerance = 1e-12;
  return newton;
}

/// A direction in the space of designs: by the cells' densities, or one joint's x or y.
enum class Way { DENSITY, JOINT_X, JOINT_Y };

/// A scene at densities of .7 .. .9, moved by h along a way, and its equilibrium at a control.
struct Design {
  std::unique_ptr<CompiledScene> compiled;
  solver::Equilibrium x;

  Design(Scene scene, Way way, double h) {
    if (way == Way::JOINT_X) scene.joints[0].x += h;
    if (way == Way::JOINT_Y) scene.joints[0].y += h;
    compiled = compileScene(scene, 1);
    std::vector<double> density(compiled->cellCount());
    for (std::size_t c = 0; c < density.size(); ++c) {
      density[c] = 0.8 + 0.1 * std::sin(5.0 * c) + (way == Way::DENSITY ? 0.04 * h * direction(c) : 0);
    }
    compiled->setDensities(density);
  }
  static double direction(std::size_t cell) { return std::cos(3.0 * static_cast<double>(cell)); }

  /// From rest, in steps.
  void trace(double control, int steps) {
    statics::PathSettings settings;
    settings.newton = tight();
    std::vector<double> targets;
    for (int k = 0; k <= steps; ++k) targets.push_back(control * k / steps);
    statics::PathFollower follower(compiled->problem(), settings);
    const statics::PathResult path = follower.follow(Eigen::VectorXd::Zero(compiled->problem().freeCount()), targets);
    ASSERT_EQ(path.status, solver::SolveStatus::CONVERGED) << path.message;
    x = follower.place();
  }
  /// From the equilibrium of a design nearby.
  void solveFrom(const solver::Equilibrium& near) {
    solver::EquilibriumSolver solver(compiled->problem(), tight());
    x = near;
    const solver::NewtonResult result = solver.minimise(x);
    EXPECT_TRUE(result.converged()) << result.message;
  }
  /// Reaction, potential, monitors.
  Eigen::VectorXd results() const {
    const std::vector<double> monitors = compiled->monitors(x.z, x.p(0));
    return Eigen::Vector4d(x.force(), x.at.energy, monitors[0], monitors[1]);
  }
};

Eigen::Vector4d claimed(const Design& design, Way way) {
  const auto sensitivity = design.compiled->sensitivity(design.x);
  const SceneSlope slopes[] = {sensitivity->reaction(), sensitivity->potential(), sensitivity->monitor(0),
                               sensitivity->monitor(1)};
  Eigen::Vector4d result;
  for (int k = 0; k < result.size(); ++k) {
    if (way == Way::DENSITY) {
      result(k) = 0;
      for (int c = 0; c < slopes[k].density.size(); ++c) {
        result(k) += slopes[k].density(c) * 0.04 * Design::direction(c);
      }
    } else {
      EXPECT_EQ(sensitivity->joints(), std::vector<int>{0});
      result(k) = slopes[k].joint(0, way == Way::JOINT_X ? 0 : 1);
    }
  }
  return result;
}

/// Its monitors: a displacement of the right bar's middle, and the rotation there.
Scene truss(int dimension) {
  Scene scene = testing_scenes::jointedTruss(dimension, dimension == 2 ? "quadratic" : "linear_reduced", 1.0);
  scene.enforcement = solver::Enforcement::MULTIPLIERS;
  scene.joints[0].y = 4.6e-3;  // off the faces between cells
  SceneMonitor middle{"middle", 1, {10e-3, 2.4e-3, 0}, {0, 1, 0}, 0};
  SceneMonitor turn{"turn", 1, {10e-3, 2.4e-3, 0}, {0, 0, 0}, 3e-3};
  scene.monitors = {middle, turn};
  return scene;
}

struct Place {
  int dimension;
  double travel;
};
void PrintTo(const Place& p, std::ostream* out) { *out << p.dimension << "-D at " << p.travel << " m"; }

class SceneAdjoint : public ::testing::TestWithParam<Place> {};

TEST_P(SceneAdjoint, MatchesDifferences) {
  const Scene scene = truss(GetParam().dimension);
  Design rest(scene, Way::DENSITY, 0);
  rest.trace(GetParam().travel, 20);
  EXPECT_EQ(rest.x.force() > 0, GetParam().travel < 4e-3) << "not in the basin that was meant";
  for (const Way way : {Way::DENSITY, Way::JOINT_X, Way::JOINT_Y}) {
    const Eigen::Vector4d expected = claimed(rest, way);
    std::map<double, Eigen::Vector4d> solved;
    const auto results = [&](double h) {
      if (solved.count(h) == 0) {
        Design moved(scene, way, h);
        moved.solveFrom(rest.x);
        solved[h] = moved.results();
      }
      return solved[h];
    };
    for (int row = 0; row < expected.size(); ++row) {
      EXPECT_TRUE(snapwing::test::derivativeMatches(
          [&](double h) { return Eigen::VectorXd::Constant(1, results(h)(row)); },
          Eigen::VectorXd::Constant(1, expected(row)), way == Way::DENSITY ? 10 : 3e-3, 1e-7))
          << "row " << row << " of way " << static_cast<int>(way);
    }
  }
  // Two polygons of 20 and 21 mm length by 2 mm, 2 mm thick; slivers of cut cells are left out.
  const double volume = 41e-3 * 2e-3 * 2e-3;
  EXPECT_NEAR(rest.compiled->multiplicity() * rest.compiled->sensitivity(rest.x)->volume().density.sum(), volume,
              0.02 * volume);
}

INSTANTIATE_TEST_SUITE_P(BothBasins, SceneAdjoint,
                         ::testing::Values(Place{2, 1e-3}, Place{2, 7e-3}, Place{3, 1e-3}, Place{3, 7e-3}));

/// Under a load: the compliance is the work that the load would do, elastic energy less the potential.
TEST(SceneSensitivity, ComplianceMatchesDifferences) {
  for (const int dimension : {2, 3}) {
    const bool space = dimension == 3;
    const Scene scene = sceneFromText(
        box(space ? "linear_reduced" : "quadratic", dimension,
            std::string("supports:\n  - {name: wall, region: {x: [0, 0]}, hold: ") + (space ? "xyz" : "xy") +
                "}\nloads:\n  - {name: push, region: {x: [3, 3]}, force: " + (space ? "[0, 4, 0]" : "[0, 4]") +
                "}\npath: {to: 1, steps: 4}\n"));
    Design rest(scene, Way::DENSITY, 0);
    rest.trace(1, 4);
    const auto sensitivity = rest.compiled->sensitivity(rest.x);
    const SceneSlope compliance = sensitivity->compliance(), reaction = sensitivity->reaction();
    double expected = 0;
    for (int c = 0; c < compliance.density.size(); ++c) {
      expected += compliance.density(c) * 0.04 * Design::direction(c);
      EXPECT_NEAR(compliance.density(c), -reaction.density(c), 1e-9 * std::abs(compliance.density(c)));
    }
    EXPECT_EQ(compliance.joint.size(), 0);
    const auto work = [&](double h) {
      Design moved(scene, Way::DENSITY, h);
      moved.solveFrom(rest.x);
      return Eigen::VectorXd::Constant(1, moved.x.at.elastic_energy - moved.x.at.energy);
    };
    EXPECT_TRUE(snapwing::test::derivativeMatches(work, Eigen::VectorXd::Constant(1, expected), 10, 1e-6))
        << dimension << "-D";
    EXPECT_GT(work(0)(0), 1e-3) << "no large strain";
  }
}

TEST(SceneSensitivity, RefusesWhatHasNone) {
  Scene scene = truss(2);
  // On the last column of the left body: beyond it there is no material to join.
  scene.joints[0].x = 0;
  Design edge(scene, Way::DENSITY, 0);
  edge.trace(1e-4, 1);
  EXPECT_THROW(edge.compiled->sensitivity(edge.x), common::Error);
}

}  // namespace
}  // namespace snapwing::scene
