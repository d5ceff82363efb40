// The arm of the feasibility study against the curve of an independent code (test/data/arms, see its header).
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <sstream>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"
#include "snapwing/scene/arm_scene.h"
#include "snapwing/statics/scene_curve.h"
#include "support/example_arm.h"
#include "support/paths.h"

namespace snapwing::statics {
namespace {

const std::string SOURCE = test::sourceDir();

struct Row {
  double travel, force, rotation;
};

std::vector<Row> reference() {
  std::istringstream text(common::readFile(SOURCE + "/test/data/arms/arm_curve_plane_stress.csv"));
  std::vector<Row> rows;
  std::string line;
  while (std::getline(text, line)) {
    Row row{};
    char comma = 0;
    std::istringstream fields(line);
    if (fields >> row.travel >> comma >> row.force >> comma >> row.rotation) {
      row.travel *= 1e-3;
      rows.push_back(row);
    }
  }
  return rows;
}

struct Traced {
  PathResult costs;
  vehicle::ForceTable table;
};

Traced traceArm(const scene::ArmSceneSettings& settings, const vehicle::ArmSettings& arm = testing::exampleArm(),
                int threads = 1) {
  const mpm::DensityField design = mpm::loadDensityCsv(SOURCE + "/data/arms/arris_x220_study.csv", 0.08, 0.04);
  vehicle::Vehicle vehicle = testing::exampleArmVehicle();
  vehicle.arm = arm;
  const scene::Scene scene = scene::armScene(vehicle, design, settings);
  const SceneCurve curve = traceScene(scene, *scene::compileScene(scene, threads), {}, {});
  return {curve.costs(), curve.table()};
}

TEST(Arm, MeetsTheIndependentCurve) {
  scene::ArmSceneSettings settings;
  settings.from = -0.005;
  settings.step = 0.002;
  const Traced curve = traceArm(settings);
  ASSERT_EQ(curve.costs.status, solver::SolveStatus::CONVERGED) << curve.costs.message;
  const std::vector<Row> rows = reference();
  ASSERT_EQ(rows.size(), 81u);
  // Same model: the reference is printed to six digits, .05 % of the peak leaves room for nothing but rounding of its
  // settings. Rotation is printed to five.
  constexpr double PEAK = 1.024;
  int compared = 0;
  for (std::size_t k = 0; k < curve.table.travel.size(); ++k) {
    const double u = curve.table.travel[k];
    EXPECT_EQ(curve.table.stable[k], 1) << u;
    EXPECT_GT(curve.table.min_det_f[k], 0.3) << u;
    if (u < -1e-9) continue;
    const Row& row = rows[static_cast<std::size_t>(std::lround(u * 1e3))];
    ASSERT_NEAR(row.travel, u, 1e-9);
    EXPECT_NEAR(curve.table.force[k], row.force, 5e-4 * PEAK) << u;
    EXPECT_NEAR(curve.table.rotation[k], row.rotation, 1e-4) << u;
    EXPECT_NEAR(curve.table.force_back[k], curve.table.force[k], 1e-4 * PEAK) << "way back at " << u;
    ++compared;
  }
  EXPECT_EQ(compared, 41);
}

/// Force is the slope of the energy and stiffness that of the force: central differences over the traced points.
TEST(Arm, ForceAndStiffnessAreDerivatives) {
  scene::ArmSceneSettings settings;
  settings.from = 0;
  settings.to = 0.02;
  settings.step = 0.00025;
  settings.back = false;
  settings.cell_size = 0.002;
  const Traced curve = traceArm(settings);
  ASSERT_EQ(curve.costs.status, solver::SolveStatus::CONVERGED);
  const auto& t = curve.table;
  for (std::size_t k = 1; k + 1 < t.travel.size(); ++k) {
    const double width = t.travel[k + 1] - t.travel[k - 1];
    EXPECT_NEAR(t.force[k], (t.energy[k + 1] - t.energy[k - 1]) / width, 2e-3);
    EXPECT_NEAR(t.stiffness[k], (t.force[k + 1] - t.force[k - 1]) / width, 0.5);
  }
}

TEST(Arm, SameBitsForAnyThreadCount) {
  scene::ArmSceneSettings settings;
  settings.from = 0;
  settings.to = 0.012;
  settings.step = 0.003;
  const Traced a = traceArm(settings), b = traceArm(settings, testing::exampleArm(), 3);
  EXPECT_EQ(a.table.force, b.table.force);
  EXPECT_EQ(a.table.stiffness, b.table.stiffness);
  EXPECT_EQ(a.table.energy, b.table.energy);
}

TEST(Arm, PlaneStrainIsStiffer) {
  scene::ArmSceneSettings settings;
  settings.from = 0;
  settings.to = 0.012;
  settings.step = 0.004;
  settings.back = false;
  settings.cell_size = 0.002;
  const Traced a = traceArm(settings);
  settings.plane = elasticity::Plane::STRAIN;
  const Traced b = traceArm(settings);
  ASSERT_EQ(b.costs.status, solver::SolveStatus::CONVERGED) << b.costs.message;
  EXPECT_GT(b.table.force[2], 1.1 * a.table.force[2]);
}

TEST(Arm, OneHugeStepEndsWithAnAnswerOrAReason) {
  scene::ArmSceneSettings settings;
  settings.from = 0;
  settings.step = 0.08 / 3;
  settings.back = false;
  const Traced curve = traceArm(settings);
  ASSERT_EQ(curve.costs.status, solver::SolveStatus::CONVERGED) << curve.costs.message;
  EXPECT_NEAR(curve.table.force.back(), 15.426318, 5e-4);
}

/// What lies below 0 joins on: no point twice, travel rises, and the way back is that of the part above.
TEST(Arm, TableLeadsFromBelowZeroThroughTheWholePath) {
  scene::ArmSceneSettings settings;
  settings.from = -0.005;
  settings.to = 0.012;
  settings.step = 0.002;
  settings.cell_size = 0.002;
  const Traced curve = traceArm(settings);
  ASSERT_EQ(curve.costs.status, solver::SolveStatus::CONVERGED) << curve.costs.message;
  const auto& t = curve.table;
  ASSERT_EQ(t.travel.size(), 3u + 7u);
  EXPECT_DOUBLE_EQ(t.travel.front(), -0.005);
  EXPECT_EQ(t.travel[3], 0);
  EXPECT_DOUBLE_EQ(t.travel.back(), 0.012);
  EXPECT_NO_THROW(t.validate());
  for (std::size_t k = 0; k < t.travel.size(); ++k) {
    EXPECT_TRUE(k == 0 || t.rotation[k] > t.rotation[k - 1]) << k;
    EXPECT_TRUE(k >= 3 || t.force_back[k] == t.force[k]) << k;
  }
  settings.from = 0;
  const Traced above = traceArm(settings);
  EXPECT_EQ(above.table.force, std::vector<double>(t.force.begin() + 3, t.force.end()));
  EXPECT_EQ(above.table.force_back, std::vector<double>(t.force_back.begin() + 3, t.force_back.end()));
}

TEST(Arm, RefusesPathsOfFewerThanThreeSteps) {
  scene::ArmSceneSettings settings;
  settings.to = 0.08;
  EXPECT_NO_THROW(settings.validate());
  for (const auto& [from, to, step] : {std::array{0.001, 0.08, 0.001}, {-0.001, 0.0, 0.001}, {0.0, 0.08, 0.027}}) {
    settings.from = from, settings.to = to, settings.step = step;
    EXPECT_THROW(settings.validate(), common::Error) << from << " " << to << " " << step;
  }
}

TEST(Arm, RefusesPinOutsideAndEmptyClamp) {
  vehicle::ArmSettings arm = testing::exampleArm();
  arm.pin_x = 0.09;
  EXPECT_THROW(traceArm({}, arm), common::Error);
  arm = testing::exampleArm();
  arm.clamp_y_low = 0.05;
  arm.clamp_y_high = 0.06;
  EXPECT_THROW(traceArm({}, arm), common::Error);
}

}  // namespace
}  // namespace snapwing::statics
