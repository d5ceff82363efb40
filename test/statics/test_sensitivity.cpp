// Adjoint derivatives against central differences of solved equilibria, at large strain in both basins.
#include <gtest/gtest.h>

#include <cmath>

#include "snapwing/mpm/cell_values.h"
#include "snapwing/scene/arm_scene.h"
#include "snapwing/scene/scene_problem.h"
#include "snapwing/solver/sensitivity.h"
#include "snapwing/statics/path.h"
#include "support/derivative_check.h"
#include "support/example_arm.h"
#include "support/paths.h"

namespace snapwing::statics {
namespace {

/// The shipped design on 4 mm cells, moved along a fixed pattern by h.
mpm::DensityField design(double h) {
  mpm::DensityField f =
      mpm::loadDensityCsv(test::sourceDir() + "/data/arms/arris_x220_study.csv", 0.08, 0.04).resampled(0.004);
  for (std::size_t c = 0; c < f.value.size(); ++c) {
    if (f.value[c] >= 0) f.value[c] = 0.25 + 0.7 * f.value[c] + 0.04 * h * std::cos(3.0 * static_cast<double>(c));
  }
  return f;
}

struct Solved {
  std::unique_ptr<scene::CompiledScene> arm;
  Eigen::VectorXd z, p;
  solver::Evaluation at;
};

Solved solveAt(double travel, double h) {
  Solved s;
  s.arm = scene::compileScene(scene::armScene(testing::exampleArmVehicle(), design(h), {}), 1);
  PathSettings settings;
  settings.newton.relative_tolerance = 1e-12;
  std::vector<double> targets;
  for (int k = 0; k <= 12; ++k) targets.push_back(travel * k / 12);
  const PathResult path =
      PathFollower(s.arm->problem(), settings).follow(Eigen::VectorXd::Zero(s.arm->problem().freeCount()), targets);
  EXPECT_EQ(path.status, solver::SolveStatus::CONVERGED) << path.message;
  s.z = path.points.back().solution;
  s.p = Eigen::VectorXd::Constant(1, travel);
  s.arm->problem().evaluate(s.z, s.p, solver::Order::TANGENT, s.at);
  return s;
}

/// Middle of the bar, down.
Eigen::VectorXd functional(const scene::CompiledScene& arm) {
  const auto& solid = *arm.planar();
  Eigen::VectorXd a = Eigen::VectorXd::Zero(solid.dofCount());
  for (const auto& [node, weight] : solid.interpolate(0, {0.041, 0.013})) a(2 * node + 1) -= weight;
  return a;
}

double along(const Eigen::VectorXd& derivative, const scene::CompiledScene& arm) {
  double sum = 0;
  const auto& solid = *arm.planar();
  for (int c = 0; c < solid.cellCount(); ++c) {
    sum += derivative(c) * 0.04 * std::cos(3.0 * solid.grid(0).cellNumber(solid.cellAt(c)));
  }
  return sum;
}

class AdjointAt : public ::testing::TestWithParam<double> {};

TEST_P(AdjointAt, MatchesDifferences) {
  const double travel = GetParam();
  const Solved s = solveAt(travel, 0);
  solver::Cholesky cholesky(s.arm->problem().pattern());
  solver::TangentSystem system(s.arm->problem(), cholesky);
  ASSERT_EQ(system.factorize(s.at), 0);
  const solver::Sensitivity sensitivity(s.arm->terms(), system, s.at, s.arm->cellCount());
  Eigen::VectorXd claimed(3);
  claimed << along(sensitivity.reaction(sensitivity.tangent()), *s.arm),
      along(sensitivity.displacement(sensitivity.adjoint(functional(*s.arm))), *s.arm) * 1e2,
      along(sensitivity.potential(), *s.arm) * 1e2;
  const auto value = [&](double h) {
    const Solved moved = solveAt(travel, h);
    Eigen::VectorXd v(3);
    v << moved.at.control_force(0), functional(*moved.arm).dot(moved.at.place.y) * 1e2, moved.at.elastic_energy * 1e2;
    return v;
  };
  for (int row = 0; row < 3; ++row) {
    EXPECT_TRUE(test::derivativeMatches([&](double h) { return Eigen::VectorXd::Constant(1, value(h)(row)); },
                                        Eigen::VectorXd::Constant(1, claimed(row)), 10, 1e-6))
        << "row " << row << " at travel " << travel;
  }
}

INSTANTIATE_TEST_SUITE_P(BothBasins, AdjointAt, ::testing::Values(0.006, 0.060));

TEST(Sensitivity, VolumeIsTheMeasureOfCells) {
  const Solved s = solveAt(0.001, 0);
  // 20 x 40 mm of 5 mm and 60 x 20 mm of 10 mm.
  EXPECT_NEAR(mpm::cellVolumes(*s.arm->planar()).sum(), 4e-6 + 12e-6, 1e-12);
}

}  // namespace
}  // namespace snapwing::statics
