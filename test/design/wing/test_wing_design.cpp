// The wing design on rigid bars: derivatives of the problem, the paper's numbers, other layouts, refusals.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"
#include "snapwing/design/wing/wing_outcome.h"
#include "wing_example.h"

namespace snapwing::design {
namespace {

using Eigen::Vector4d;

TEST(WingProblem, ObjectiveAndConstraintsMatchDifferences) {
  WingSettings settings = paperSettings();
  settings.dwell_weight = 0.05;
  const RigidWingProblem problem(settings);
  int looked_at = 0;
  for (const FourBar& bar : randomFeasible(12, 0.93, 0.2, 4)) {
    const Vector4d X = variablesOf(bar);
    const double coarse = slopeError(problem, X, 1e-5), fine = slopeError(problem, X, 1e-6);
    EXPECT_LT(fine, 0.05 * coarse + 2e-8);
    EXPECT_LT(fine, 1e-6);
    EXPECT_GT(problem.evaluate(X, true).gradient.norm(), 1e-6);
    ++looked_at;
  }
  EXPECT_EQ(looked_at, 12);
}

TEST(WingProblem, ObjectiveIsThePapersWhenTheExtraWeightsAreZero) {
  WingSettings settings = paperSettings();
  settings.rotation_weight = 0;
  const FourBar bar = paperDesign().linkage;
  double sum = 0;
  for (int i = 0; i < 2; ++i) {
    sum += (poseAt(bar, settings.targets[i].arm_rotation)->tip - settings.tipTarget(i)).squaredNorm();
  }
  EXPECT_NEAR(RigidWingProblem(settings).evaluate(variablesOf(bar), false).objective, sum, 1e-6 * sum);
}

TEST(WingDesign, PaperNumbersAreMet) {
  const WingSettings settings = paperSettings();
  const WingDesign& design = paperDesign();
  ASSERT_EQ(design.status, WingStatus::DESIGNED) << design.message;
  for (const WingState& state : design.states) {
    EXPECT_LT(std::abs(state.rotation_error), 0.15);
    EXPECT_LT(state.tip_residual, 0.005);
  }
  // Nearly at rest between the driven states: a small part of what the wing turns on average per arm rotation.
  const double between = design.states[1].pose.wing_rotation - design.states[0].pose.wing_rotation;
  const double average = design.states[0].pose.wing_rotation / 0.83;
  EXPECT_LT(std::abs(between / 0.10), 0.25 * average);
  EXPECT_GE(design.separation, settings.separation - 1e-8);
  EXPECT_GE(design.joint2_x, settings.wall_joint2_x - 1e-8);
  EXPECT_LE(design.joint1_y, settings.wall_joint1_y + 1e-8);
  EXPECT_TRUE(design.travel.closes);
  EXPECT_GE(design.travel.smallest_transmission, settings.transmission_margin - 2e-3);
  for (int k = 0; k <= 200; ++k) {
    const auto pose = poseAt(design.linkage, 0.93 * k / 200);
    ASSERT_TRUE(pose);
    EXPECT_EQ(design.linkage.branchOf(pose->joint1, pose->joint2), design.linkage.branch());
  }
}

TEST(WingDesign, SameSettingsSameBits) {
  const WingDesign again = designWing(RigidWingProblem(paperSettings()));
  EXPECT_EQ(variablesOf(again.linkage), variablesOf(paperDesign().linkage));
  EXPECT_EQ(again.objective, paperDesign().objective);
}

TEST(WingDesign, MmaReachesTheSameValley) {
  WingSettings settings = paperSettings();
  settings.optimizer = "nlopt_mma";
  settings.starts = 12;
  const WingDesign mma = designWing(RigidWingProblem(settings));
  ASSERT_EQ(mma.status, WingStatus::DESIGNED) << mma.message;
  // The valley is flat along joint 2: MMA may stop short of its floor, but not by more than a few per cent.
  EXPECT_LT(mma.objective, 1.05 * paperDesign().objective);
  EXPECT_GT(mma.objective, 0.99 * paperDesign().objective);
}

TEST(WingDesign, OwnMmaReachesTheSameOptimum) {
  WingSettings settings = paperSettings();
  settings.optimizer = "own_mma";
  const RigidWingProblem problem(settings);
  for (const auto& start : sampleLayouts(problem, settings.samples, 2, static_cast<unsigned>(settings.seed))) {
    const LocalResult run = improve(problem, start);
    EXPECT_NE(run.stop.find("own MMA"), std::string::npos);
    EXPECT_LE(run.violation, 1e-6);
    EXPECT_NEAR(run.objective, paperDesign().objective, 1e-3 * paperDesign().objective);
  }
}

TEST(WingOutcome, FilesAreFoundAgainAndTheBladeIsTabulated) {
  WingSettings settings = paperSettings();
  settings.samples = 8000;
  settings.starts = 4;
  WingJob job;
  job.folder = testing::TempDir() + "wing_outcome";
  std::filesystem::remove_all(job.folder);
  EXPECT_FALSE(loadWingOutcome(settings, job.folder).has_value());
  int told = 0;
  job.go_on = [&](const WingProgress& p) { return p.run == told++ && p.runs == 4; };
  const WingOutcome made = designWingInto(settings, job);
  ASSERT_EQ(made.design.status, WingStatus::DESIGNED) << made.design.message;
  EXPECT_EQ(told, 4);
  EXPECT_TRUE(made.targets_met);
  EXPECT_TRUE(made.comparison.converged);
  const auto found = loadWingOutcome(settings, job.folder);
  ASSERT_TRUE(found.has_value());
  EXPECT_TRUE(found->from_store && found->targets_met);
  EXPECT_NEAR(found->design.objective, made.design.objective, 1e-12);
  const WingTable& t = found->table;
  ASSERT_TRUE(t.hasBlade());
  EXPECT_EQ(t.kinetic_mass, made.table.kinetic_mass);
  // Bounds from the tip's speed alone: some of the rod below, the whole wing at twice that speed above.
  const double rate = (t.tip_y[1] - t.tip_y[0]) / (t.travel[1] - t.travel[0]);
  EXPECT_GT(t.kinetic_mass[0], 0.3 * 2 * 0.005 * rate * rate);
  EXPECT_LT(t.kinetic_mass[0], 2 * made.mass * 4 * rate * rate);
  // No motion of the wings' mass has less energy than that of its own centre: S^2 <= m K.
  for (std::size_t i = 0; i < t.travel.size(); ++i) {
    EXPECT_LE(t.coupled_mass[i] * t.coupled_mass[i], 2 * made.mass * t.kinetic_mass[i] * (1 + 1e-9)) << i;
  }
  EXPECT_NE(wingHash(settings, WingRung::RIGID), wingHash(settings, WingRung::SOLIDS));
}

TEST(WingBladeInertia, CoupledMassIsTheMotionOfTheCentre) {
  const WingSettings settings = paperSettings();
  const vehicle::Vehicle vehicle = vehicle::loadVehicle(settings.vehicle_file);
  const WingBlade blade(layoutOf(settings, paperDesign(), vehicle, "rigid"));
  const ArmMotion& motion = *settings.motion;
  vehicle::WingTable table = *tabulate(paperDesign().linkage, motion, motion.largestTravel(), 41);
  addBlade(blade, motion, &table);
  for (const int i : {3, 10, 20, 35}) {
    double best = INFINITY;
    for (const double h : {1e-3, 1e-4, 1e-5, 1e-6}) {
      const auto height = [&](double u) {
        const MassProperties m = blade.massAt(*blade.poseAt(motion.rotation(u), WingSide::RIGHT));
        return 2 * m.mass * m.centre.z();
      };
      const double s = (height(table.travel[i] + h) - height(table.travel[i] - h)) / (2 * h);
      best = std::min(best, std::abs(s - table.coupled_mass[i]));
    }
    EXPECT_LT(best, 1e-6) << i;
  }
}

TEST(WingOutcome, TheStoredObjectiveIsThatOfItsRung) {
  WingSettings settings = paperSettings();
  settings.samples = 4000;
  settings.starts = 1;
  settings.compliance_weight = 1e4;  // so that the rungs' objectives differ
  WingJob job;
  job.rung = WingRung::BEAMS;
  job.points = 21;
  job.folder = testing::TempDir() + "wing_outcome_beams";
  const WingOutcome made = designWingInto(settings, job);
  ASSERT_EQ(made.design.status, WingStatus::DESIGNED) << made.design.message;
  const auto found = loadWingOutcome(settings, job.folder);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->layout.rung, "elastic");
  EXPECT_NEAR(found->design.objective, made.design.objective, 1e-9 * made.design.objective);
  const Eigen::Vector4d X = variablesOf(found->layout.linkage);
  EXPECT_GT(made.design.objective, 1.001 * RigidWingProblem(settings).evaluate(X, false).objective);
}

TEST(WingClearance, FallsWhereThePropellersGrow) {
  const WingSettings settings = paperSettings();
  vehicle::Vehicle vehicle = vehicle::loadVehicle(settings.vehicle_file);
  const WingBlade blade(layoutOf(settings, paperDesign(), vehicle, "rigid"));
  const WingClearance small = clearanceOf(blade, vehicle);
  EXPECT_GT(small.bars, 0);
  EXPECT_LT(small.bars, 0.1);
  vehicle.geometry.rotor_radius += 0.005;
  const WingClearance large = clearanceOf(blade, vehicle);
  EXPECT_LE(large.bars, small.bars);
  EXPECT_NEAR(large.bars, small.bars, 0.005 + 1e-9);
}

TEST(WingDesign, OtherTargetsOfOtherLinkagesAreRecovered) {
  // Targets made from random feasible linkages: the design must find a layout that reaches them.
  int recovered = 0;
  for (const FourBar& bar : randomFeasible(5, 0.93, 0.4, 21)) {
    WingSettings s = paperSettings();
    s.rotation_weight = 0.0;
    s.separation = 0.012;
    s.wall_joint1_y = 0.2;
    s.wall_joint2_x = -0.2;
    const Eigen::Vector2d t1 = poseAt(bar, 0.83)->tip, t2 = poseAt(bar, 0.93)->tip;
    // A circle through rest, and both driven places of the tip: its centre is the rotation centre of the targets.
    const Eigen::Vector2d t0 = bar.tip;
    Eigen::Matrix2d A;
    A << (t1 - t0).transpose(), (t2 - t0).transpose();
    const Eigen::Vector2d b(0.5 * (t1.squaredNorm() - t0.squaredNorm()), 0.5 * (t2.squaredNorm() - t0.squaredNorm()));
    s.rotation_centre = A.fullPivLu().solve(b);
    const Eigen::Vector2d r0 = t0 - s.rotation_centre;
    if (r0.norm() > 0.9) continue;
    s.tip_radius = r0.norm();
    s.tip_direction = std::atan2(r0.y(), r0.x());
    const auto turned = [&](const Eigen::Vector2d& t) {
      const Eigen::Vector2d r = t - s.rotation_centre;
      return std::atan2(r0.x() * r.y() - r0.y() * r.x(), r0.dot(r));
    };
    s.wing_sign = turned(t2) > 0 ? 1 : -1;
    s.targets[0].wing_rotation = s.wing_sign * turned(t1);
    s.targets[1].wing_rotation = s.wing_sign * turned(t2);
    const WingDesign design = designWing(RigidWingProblem(s));
    ASSERT_EQ(design.status, WingStatus::DESIGNED) << design.message;
    EXPECT_LT(design.states[0].tip_residual, 1e-3);
    EXPECT_LT(design.states[1].tip_residual, 1e-3);
    EXPECT_TRUE(design.travel.closes);
    ++recovered;
  }
  EXPECT_GE(recovered, 3);
}

TEST(WingDesign, WallsThatLeaveNoRoomAreReportedNotHidden) {
  WingSettings settings = paperSettings();
  settings.samples = 4000;
  settings.wall_joint1_y = -0.5;
  const WingDesign design = designWing(RigidWingProblem(settings));
  EXPECT_EQ(design.status, WingStatus::INFEASIBLE);
  EXPECT_NE(design.message.find("within the constraints"), std::string::npos);
}

TEST(WingDesign, CanBeCancelled) {
  WingSettings settings = paperSettings();
  settings.samples = 2000;
  int asked = 0;
  const WingDesign design = designWing(RigidWingProblem(settings), [&](const WingProgress&) { return ++asked < 3; });
  EXPECT_EQ(design.status, WingStatus::CANCELLED);
  EXPECT_EQ(design.runs, 2);
}

TEST(WingDesign, CanBeCancelledWithinARun) {
  WingSettings settings = paperSettings();
  settings.samples = 2000;
  for (const char* optimizer : {"nlopt_slsqp", "nlopt_mma", "own_mma"}) {
    settings.optimizer = optimizer;
    int asked = 0;
    const WingDesign design = designWing(RigidWingProblem(settings), nullptr, [&] { return ++asked > 5; });
    EXPECT_EQ(design.status, WingStatus::CANCELLED) << optimizer;
    EXPECT_EQ(design.runs, 0);
    EXPECT_LE(asked, 6);
  }
}

WingSettings withText(const std::string& from, const std::string& to) {
  std::string text = common::readFile(paperFile());
  const auto at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("test text is gone: " + from);
  text.replace(at, from.size(), to);
  const auto path = std::filesystem::path(testing::TempDir()) / "wing_changed.yaml";
  std::ofstream(path) << text;
  return loadWingSettings(path);
}

TEST(WingSettings, MistakesAreNamed) {
  EXPECT_THROW(withText("tip_radius: 0.100", "tip_radius: 100.0"), common::SettingError);
  EXPECT_THROW(withText("tip_radius", "tip_radios"), common::SettingError);
  EXPECT_THROW(withText("arm_turns: counter_clockwise", "arm_turns: left"), common::SettingError);
  EXPECT_THROW(withText("{arm_rotation: 0.93,", "{arm_rotation: 0.80,"), common::SettingError);
  EXPECT_THROW(withText("{arm_rotation: 0.93,", "{arm_rotation: 1.50,"), common::Error);
  EXPECT_THROW(withText("travel: [0.0, 0.052, 0.070]", "travel: [0.0, 0.072, 0.070]"), common::Error);
  EXPECT_THROW(withText("targets:", "rung: steel\ntargets:"), common::SettingError);
  EXPECT_THROW(withText("targets:", "layers: {most_layers: 9}\ntargets:"), common::SettingError);
  EXPECT_NO_THROW(withText("tip_radius: 0.100", "tip_radius: 0.110"));
  EXPECT_EQ(withText("targets:", "rung: solid\ntargets:").rung, "solid");
  EXPECT_EQ(withText("targets:", "layers: {gap: 0.002}\ntargets:").stack.gap, 0.002);
}

TEST(ArmMotion, PassesThroughItsPointsAndItsSlopeIsItsDerivative) {
  const ArmMotion motion({0, 0.02, 0.05, 0.08}, {0, 0.3, 0.8, 0.95}, "test");
  EXPECT_DOUBLE_EQ(motion.rotation(0.05), 0.8);
  for (double u = 0.001; u < 0.0795; u += 0.0013) {
    const double h = 1e-7;
    EXPECT_NEAR((motion.rotation(u + h) - motion.rotation(u - h)) / (2 * h), motion.slope(u), 2e-3);
    EXPECT_GT(motion.slope(u), 0);
    EXPECT_NEAR(motion.travelAt(motion.rotation(u)), u, 1e-12);
  }
  EXPECT_THROW(motion.rotation(0.081), common::Error);
  EXPECT_THROW(motion.travelAt(1.0), common::Error);
}

TEST(ArmMotion, ComesFromAForceTable) {
  vehicle::ForceTable table;
  table.travel = {-0.01, 0, 0.02, 0.05, 0.07};
  table.rotation = {-0.2, 0, 0.3, 0.83, 0.93};
  const ArmMotion motion = ArmMotion::fromTable(table, "test");
  EXPECT_DOUBLE_EQ(motion.rotation(0), 0);
  EXPECT_DOUBLE_EQ(motion.rotation(0.07), 0.93);
}

}  // namespace
}  // namespace snapwing::design
