// What the arm's design can do besides the default: limits, solids, stages, threads, other mechanisms, ends that are
// told.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "design_scene.h"
#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"
#include "snapwing/design/arm/arm_outcome.h"
#include "snapwing/design/arm/arm_topology.h"
#include "snapwing/design/design_program.h"
#include "snapwing/solver/newton.h"
#include "snapwing/statics/path.h"
#include "support/own_folder.h"
#include "support/paths.h"

namespace snapwing::design {
namespace {

const std::string ROOT = test::sourceDir();

/// Few states on 4 mm cells.
ArmDesignSettings tiny() {
  ArmDesignSettings s = loadArmDesignSettings(ROOT + "/test/data/designs/arm_tiny.yaml");
  s.stages[0].iterations = 4;
  return s;
}

void expectGoodGradients(const GradientCheck& check, std::size_t rows) {
  ASSERT_TRUE(check.valid) << check.message;
  ASSERT_EQ(check.rows.size(), rows);
  for (const GradientRow& row : check.rows) {
    EXPECT_LT(row.best(), 1e-6) << row.quantity;
    EXPECT_NE(row.derivative, 0) << row.quantity;
  }
}

TEST(ArmLimits, MassAndStrainHaveExactGradients) {
  ArmDesignSettings s = tiny();
  s.mass_limit = 0.015;
  s.strain_limit = 0.5;
  s.strain_travels = {0.030, 0.070};
  s.compliance_force = 0;
  // objective, peak, valley, two strains, volume, mass
  expectGoodGradients(checkArmGradients(s, 0.5), 7);
}

TEST(ArmLimits, RotationAndMeanForceHaveExactGradients) {
  for (const bool volumetric : {false, true}) {
    ArmDesignSettings s = tiny();
    s.stages = {{volumetric, 0.004, 4, 0.05}};
    s.valley_range = {0.014, 0.020};
    s.valley_travels = {0.020};
    s.rotation_bound = {0.10, 0.20};
    s.rotation_travels = {0.010, 0.020};
    s.compliance_force = 0;
    s.peak_share_least = 0.8;
    // objective, peak from both sides, valley, rotation at two travels from both sides, volume
    const GradientCheck check = checkArmGradients(s, 0.5);
    expectGoodGradients(check, 9);
    // A central difference's error falls with the square of its step, wherever it is not rounding yet.
    for (const GradientRow& row : check.rows) EXPECT_LT(row.relative_errors[1], 1e-3) << row.quantity;
  }
}

/// Of the same rotation and energy as the check's curve.
TEST(ArmLimits, RotationAndMeanForceAreThoseOfTheCheck) {
  ArmDesignSettings s = tiny();
  s.rotation_bound = {0, 1};
  s.rotation_travels = {0.020};
  s.valley_range = {0.012, 0.020};
  s.compliance_force = 0;
  ArmTopology problem(s, 0, 1e-12);
  problem.beginIteration(0, 4);
  const Eigen::VectorXd x = problem.start();
  const Evaluated at = problem.evaluate(x, false);
  ASSERT_TRUE(at.valid) << at.message;
  // Rows: peak, valley, rotation from above and below (over half of the interval).
  EXPECT_NEAR(at.constraints(2) + at.constraints(3), -2, 1e-9);
  const mpm::DensityField field = problem.field(x);
  const auto arm = scene::compileScene(designScene(s, {false, false, field.cell_size, 0.002}, &field), 1);
  statics::PathSettings tight;
  tight.newton.relative_tolerance = 1e-12;
  std::vector<double> targets;
  for (int k = 0; k <= 10; ++k) targets.push_back(0.002 * k);
  const statics::PathResult path =
      statics::PathFollower(arm->problem(), tight).follow(Eigen::VectorXd::Zero(arm->problem().freeCount()), targets);
  ASSERT_EQ(path.points.size(), targets.size()) << path.message;
  const auto &peak = path.points[5], &from = path.points[6], &to = path.points[10];
  EXPECT_NEAR(0.5 * at.constraints(2) + 1, arm->monitors(to.solution, 0.020)[0], 1e-8);
  const double mean = (to.energy - from.energy) / 0.008;
  EXPECT_NEAR(at.objective * s.peak_bound, mean - peak.force, 1e-7);
  EXPECT_GT(mean, 0);
}

TEST(ArmBounds, ThePeakKeepsItsShareOfTheUpperBound) {
  ArmDesignSettings s = tiny();
  const auto constraintsOf = [](const ArmDesignSettings& settings) {
    ArmTopology problem(settings, 0, 1e-12);
    problem.beginIteration(0, 4);
    const Evaluated at = problem.evaluate(problem.start(), false);
    EXPECT_TRUE(at.valid) << at.message;
    return at.constraints;
  };
  s.peak_travels = {s.peak_travel};
  const double share_there = constraintsOf(s)(0) + 1;
  s.peak_share_least = 0.8;
  const Eigen::VectorXd with = constraintsOf(s);
  EXPECT_NEAR(with(0), share_there - 1, 1e-9);
  EXPECT_NEAR(with(1), 1 - share_there / 0.8, 1e-9);
}

TEST(ArmLimits, StrainBoundsTheLargestStretch) {
  ArmDesignSettings s = tiny();
  const Mechanism arm(designScene(s, {false, false, 0.004, 0.001}, nullptr), 0, 1);
  solver::Newton newton(arm.problem(), {});
  Eigen::VectorXd z = Eigen::VectorXd::Zero(arm.problem().freeCount());
  solver::Evaluation at;
  ASSERT_TRUE(newton.solve(Eigen::VectorXd::Constant(1, 0.002), z, at).converged());
  const Mechanism::Strain sharp = arm.strain(40, nullptr, at), blunt = arm.strain(4, nullptr, at);
  EXPECT_GT(sharp.largest, 0);
  EXPECT_GE(sharp.value, sharp.largest);
  EXPECT_GT(blunt.value, sharp.value);
  EXPECT_LT(sharp.value, 1.2 * sharp.largest);  // the aggregate tends to the largest
}

TEST(ArmVolumetric, GradientsOfColumnsAreExact) {
  ArmDesignSettings s = tiny();
  s.stages = {{true, 0.004, 4, 0.05}};
  s.valley_range = {0.020, 0.020};
  s.valley_travels = {0.020};
  s.compliance_force = 0;
  expectGoodGradients(checkArmGradients(s, 0.5), 4);
}

/// Ten millimetres are five cells of two: no mirror plane between cells, and the whole thickness slides along the axle.
TEST(ArmVolumetric, HalfTheThicknessAtAnyCellSize) {
  const ArmDesignSettings s = tiny();
  for (const double cell : {0.0025, 0.002, 0.004}) {
    const Mechanism arm(designScene(s, {true, false, cell, 0.001}, nullptr), 0, 1);
    EXPECT_EQ(arm.multiplicity(), 2) << cell;
    // Leg and bar have their volume, even where their thickness ends between the samples of a cell.
    EXPECT_NEAR(arm.areas().sum(), 0.020 * 0.040 + 0.060 * 0.020, 1e-12) << cell;
  }
}

TEST(ArmStages, PlanarDesignStartsTheSolid) {
  ArmDesignSettings s = tiny();
  s.stages = {{false, 0.004, 3, 0.05}, {false, 0.002, 2, 0.05}, {true, 0.004, 1, 0.05}};
  const ArmRun run = runArmDesign(s, {});
  ASSERT_EQ(run.history.size(), 6u);
  EXPECT_EQ(run.history.back().stage, 2);
  for (std::size_t k = 1; k < run.history.size(); ++k) {
    EXPECT_EQ(run.history[k].report.iteration, static_cast<int>(k));
    // A stage begins where the one before ended: one step of at most the move limit, and the other cells.
    EXPECT_NEAR(run.history[k].volume, run.history[k - 1].volume, 0.05);
  }
  // The force of the solid at the first bound is that of the planar arm up to the models' difference.
  EXPECT_NEAR(run.history[5].forces[0], run.history[2].forces[0], 0.3 * run.history[2].forces[0]);
}

void expectSameBitsOnAnyThreads(ArmDesignSettings s) {
  s.thresholds = {0.5, 0.58, 0.42};
  s.threads = 1;
  const ArmRun one = runArmDesign(s, {});
  s.threads = 2;
  const ArmRun two = runArmDesign(s, {});
  EXPECT_EQ(one.field.value, two.field.value);
  EXPECT_EQ(one.forces, two.forces);
  EXPECT_EQ(one.result.objective, two.result.objective);
}

TEST(ArmThreads, DoNotChangeABit) { expectSameBitsOnAnyThreads(tiny()); }

/// A solid's states are dealt out to more tasks than it has variants.
TEST(ArmThreads, DoNotChangeABitOfASolid) {
  ArmDesignSettings s = tiny();
  s.stages = {{true, 0.004, 2, 0.05}};
  s.slope_travels = {0.008, 0.012, 0.016, 0.020};
  s.valley_range = {0.024, 0.024};
  s.valley_travels = {0.024};
  expectSameBitsOnAnyThreads(s);
}

TEST(ArmEnds, AnUnreachableBoundIsInfeasibleAndNamed) {
  ArmDesignSettings s = tiny();
  s.peak_bound = 1e-3;
  const ArmRun run = runArmDesign(s, {});
  EXPECT_EQ(run.result.status, OptimizerStatus::INFEASIBLE);
  EXPECT_NE(run.worst.find("R(0.01 m) <= 0.001 N"), std::string::npos) << run.worst;
  EXPECT_NE(run.result.message.find(run.worst), std::string::npos);
}

TEST(ArmEnds, AForceThatTheArmCannotHoldIsSaid) {
  ArmDesignSettings s = tiny();
  s.start_density = 0.02;
  s.compliance_force = 100;
  const ArmRun run = runArmDesign(s, {});
  EXPECT_EQ(run.result.status, OptimizerStatus::EVALUATION_FAILED);
  EXPECT_NE(run.result.message.find("compliance force"), std::string::npos) << run.result.message;
}

/// The switch's settings with its scene changed by one replacement.
std::string switchWith(const std::string& from, const std::string& to) {
  std::string scene = common::readFile(ROOT + "/config/scenes/switch_domain.yaml");
  const std::size_t at = scene.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  if (at != std::string::npos) scene.replace(at, from.size(), to);
  const std::string folder = test::ownFolder();
  std::ofstream(folder + "switch_scene.yaml") << scene;
  std::string design = common::readFile(ROOT + "/config/designs/mechanism_switch.yaml");
  design.replace(design.find("../scenes/switch_domain.yaml"), 28, "switch_scene.yaml");
  std::ofstream(folder + "switch_design.yaml") << design;
  return folder + "switch_design.yaml";
}

ArmDesignSettings coarseSwitch(const std::string& file) {
  ArmDesignSettings s = loadArmDesignSettings(file);
  s.stages = {{false, 0.004, 3, 0.05}};
  s.check_cells = {0.002};
  s.check_quadratic_cells = s.check_volumetric_cells = {};
  s.check_step = 0.002;
  return s;
}

TEST(ArmMechanism, AnyBodyOfASceneCanBeDesigned) {
  const ArmDesignSettings s = coarseSwitch(ROOT + "/config/designs/mechanism_switch.yaml");
  EXPECT_EQ(s.copies, 2);
  ArmJob job;
  job.folder = ::testing::TempDir() + "switch_outcome";
  const ArmOutcome outcome = designArm(s, job);
  EXPECT_EQ(outcome.iterations, 3);
  // Its port is on the domain's far edge; the check must find a body there, once without a printing error.
  EXPECT_TRUE(std::filesystem::exists(job.folder + "/curve_2.00_mm.h5"));
  const std::string report = common::readFile(job.folder + "/report.json");
  EXPECT_EQ(report.find("\"2.00 mm\""), report.rfind("\"2.00 mm\""));
  EXPECT_EQ(report.find("rotation there"), std::string::npos);  // no monitor of one
  EXPECT_FALSE(outcome.densityFile().empty());
  const auto found = loadArmOutcome(s, job.folder);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->objective, outcome.objective);
  ArmDesignSettings other = s;
  other.inputs_sha256 += "x";
  EXPECT_FALSE(loadArmOutcome(other, job.folder).has_value());
  std::string foreign = report;
  foreign.replace(foreign.find(designProgram()), designProgram().size(), "0.1.0+aa");
  std::ofstream(job.folder + "/report.json") << foreign;
  EXPECT_FALSE(loadArmOutcome(s, job.folder).has_value());
}

TEST(ArmMechanism, ARotationBoundNeedsAMonitorAndSaysSo) {
  const std::string wanted = "  rotation: [0.1, 0.2]\n  rotation_travels: [0.018]\n";
  const auto withBound = [&](const std::string& from, const std::string& to) {
    const std::string file = switchWith(from, to);
    std::string design = common::readFile(file);
    design.insert(design.find("  peak_force: "), wanted);
    std::ofstream(file) << design;
    return file;
  };
  try {
    loadArmDesignSettings(withBound("copies: 2", "copies: 2"));
    FAIL() << "accepted";
  } catch (const common::SettingError& e) {
    EXPECT_NE(std::string(e.what()).find("bounds.rotation"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("monitor"), std::string::npos) << e.what();
  }
  const std::string monitor = "copies: 2\nmonitors:\n  - {name: turn, body: spring, at: [20, 10], radius: 5}";
  const ArmDesignSettings s = coarseSwitch(withBound("copies: 2", monitor));
  EXPECT_EQ(s.rotation_travels, std::vector<double>{0.018});
  ArmTopology problem(s);
  problem.beginIteration(0, 3);
  EXPECT_TRUE(problem.evaluate(problem.start(), true).valid);
  ArmDesignSettings blind = coarseSwitch(ROOT + "/config/designs/mechanism_switch.yaml");
  blind.rotation_bound = {0.1, 0.2};
  blind.rotation_travels = {0.018};
  EXPECT_THROW(ArmTopology(blind, 0), common::Error);
}

/// The weight of a design follows it: its gradients are exact, and another load gives other forces.
TEST(ArmMechanism, WeightFollowsTheDesign) {
  const std::string monitor = "copies: 2\nmonitors:\n  - {name: turn, body: spring, at: [20, 10], radius: 5}";
  ArmDesignSettings light = coarseSwitch(switchWith("copies: 2", monitor));
  light.rotation_bound = {0.1, 0.2};
  light.rotation_travels = {0.018};
  ArmDesignSettings heavy = light;
  heavy.scene.gravity << 300.0, -600.0, 0.0;  // of the order of the switch's own forces
  ArmTopology without(light, 0), with(heavy, 0);
  for (ArmTopology* problem : {&without, &with}) problem->beginIteration(0, 3);
  const Evaluated a = without.evaluate(without.start(), false), b = with.evaluate(with.start(), false);
  ASSERT_TRUE(a.valid && b.valid) << a.message << b.message;
  EXPECT_GT(std::abs(a.constraints(0) - b.constraints(0)), 0.02) << "the peak's force feels the weight";
  expectGoodGradients(checkArmGradients(heavy, 0.5), checkArmGradients(light, 0.5).rows.size());
  heavy.stages[0].volumetric = true;
  const GradientCheck solid = checkArmGradients(heavy, 0.5);
  expectGoodGradients(solid, solid.rows.size());
}

TEST(ArmMechanism, PortOutsideOfTheBodyIsNamed) {
  const ArmDesignSettings s = coarseSwitch(switchWith("x: [40, 40], y: [12, 20]", "x: [60, 60], y: [12, 20]"));
  try {
    runArmDesign(s, {});
    FAIL() << "accepted";
  } catch (const common::Error& e) {
    EXPECT_NE(std::string(e.what()).find("button"), std::string::npos) << e.what();
  }
}

TEST(ArmMechanism, EmptyDomainAndUnknownBodyAreRefused) {
  EXPECT_THROW(runArmDesign(coarseSwitch(switchWith("shape: {box: {x: [0, 40], y: [0, 20]}}",
                                                    "shape: {difference: [{box: {x: [0, 40], y: [0, 20]}}, {box: {x: "
                                                    "[-1, 41], y: [-1, 21]}}]}")),
                            {}),
               common::Error);
  EXPECT_THROW(loadArmDesignSettings(switchWith("  spring:", "  coil:")), common::SettingError);
  EXPECT_THROW(loadArmDesignSettings(switchWith("path: {to: 26", "path: {to: -26")), common::SettingError);
}

}  // namespace
}  // namespace snapwing::design
