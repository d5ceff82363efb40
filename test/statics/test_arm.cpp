// The arm of the feasibility study against the curve of an independent code (test/data/arms, see its header).
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"
#include "snapwing/statics/arm_problem.h"
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

ArmProblem makeArm(const ArmProblemSettings& settings, const vehicle::ArmSettings& arm = testing::exampleArm()) {
  const mpm::DensityField design = mpm::loadDensityCsv(SOURCE + "/data/arms/arris_x220_study.csv", 0.08, 0.04);
  return ArmProblem(arm, {5.5e6, 0.48, 1210}, design, settings);
}

TEST(Arm, MeetsTheIndependentCurve) {
  ArmCurveSettings settings;
  settings.from = -0.005;
  settings.step = 0.002;
  const ArmCurve curve = traceArm(makeArm({}), settings);
  ASSERT_EQ(curve.status, solver::SolveStatus::CONVERGED) << curve.message;
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
  ArmCurveSettings settings;
  settings.from = 0;
  settings.to = 0.02;
  settings.step = 0.00025;
  settings.back = false;
  ArmProblemSettings coarse;
  coarse.cell_size = 0.002;
  const ArmCurve curve = traceArm(makeArm(coarse), settings);
  ASSERT_EQ(curve.status, solver::SolveStatus::CONVERGED);
  const auto& t = curve.table;
  for (std::size_t k = 1; k + 1 < t.travel.size(); ++k) {
    const double width = t.travel[k + 1] - t.travel[k - 1];
    EXPECT_NEAR(t.force[k], (t.energy[k + 1] - t.energy[k - 1]) / width, 2e-3);
    EXPECT_NEAR(t.stiffness[k], (t.force[k + 1] - t.force[k - 1]) / width, 0.5);
  }
}

TEST(Arm, SameBitsForAnyThreadCount) {
  ArmCurveSettings settings;
  settings.from = 0;
  settings.to = 0.012;
  settings.step = 0.003;
  ArmProblemSettings one, three;
  three.threads = 3;
  const ArmCurve a = traceArm(makeArm(one), settings), b = traceArm(makeArm(three), settings);
  EXPECT_EQ(a.table.force, b.table.force);
  EXPECT_EQ(a.table.stiffness, b.table.stiffness);
  EXPECT_EQ(a.table.energy, b.table.energy);
}

TEST(Arm, PlaneStrainIsStiffer) {
  ArmCurveSettings settings;
  settings.from = 0;
  settings.to = 0.012;
  settings.step = 0.004;
  settings.back = false;
  ArmProblemSettings stress, strain;
  stress.cell_size = strain.cell_size = 0.002;
  strain.plane = elasticity::Plane::STRAIN;
  const ArmCurve a = traceArm(makeArm(stress), settings), b = traceArm(makeArm(strain), settings);
  ASSERT_EQ(b.status, solver::SolveStatus::CONVERGED) << b.message;
  EXPECT_GT(b.table.force[2], 1.1 * a.table.force[2]);
}

TEST(Arm, OneHugeStepEndsWithAnAnswerOrAReason) {
  ArmCurveSettings settings;
  settings.from = 0;
  settings.step = 0.08 / 3;
  settings.back = false;
  const ArmCurve curve = traceArm(makeArm({}), settings);
  ASSERT_EQ(curve.status, solver::SolveStatus::CONVERGED) << curve.message;
  EXPECT_NEAR(curve.table.force.back(), 15.426318, 5e-4);
}

TEST(Arm, RefusesPinOutsideAndEmptyClamp) {
  vehicle::ArmSettings arm = testing::exampleArm();
  arm.pin_x = 0.09;
  EXPECT_THROW(makeArm({}, arm), common::Error);
  arm = testing::exampleArm();
  arm.clamp_y_low = 0.05;
  arm.clamp_y_high = 0.06;
  EXPECT_THROW(makeArm({}, arm), common::Error);
}

TEST(Arm, ImpossibleTravelIsReportedNotInvented) {
  ArmCurveSettings settings;
  settings.from = 0;
  settings.to = 3.0;  // thirty times the arm's length
  settings.step = 1.0;
  settings.back = false;
  settings.path.smallest_step = 0.25;
  settings.path.newton.max_iterations = 5;
  ArmProblemSettings coarse;
  coarse.cell_size = 0.002;
  const ArmCurve curve = traceArm(makeArm(coarse), settings);
  EXPECT_NE(curve.status, solver::SolveStatus::CONVERGED);
  EXPECT_FALSE(curve.message.empty());
  for (const double f : curve.table.force) EXPECT_TRUE(std::isfinite(f));
}

}  // namespace
}  // namespace snapwing::statics
