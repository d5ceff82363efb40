// Blade, layout file and table of the designed wing.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"
#include "snapwing/design/wing/wing_blade.h"
#include "snapwing/design/wing/wing_table.h"
#include "wing_example.h"

namespace snapwing::design {
namespace {

using Eigen::Vector3d;

WingLayout layout() {
  const WingSettings settings = paperSettings();
  return layoutOf(settings, paperDesign(), vehicle::loadVehicle(settings.vehicle_file), "rigid");
}

std::string temporary(const std::string& name) { return std::filesystem::path(testing::TempDir()) / name; }

double angleBetween(const Vector3d& a, const Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

TEST(WingBlade, PanelsKeepTheirShapeWhileTheFanFolds) {
  const WingBlade blade(layout());
  double last = 10;
  for (int k = 0; k <= 50; ++k) {
    const auto pose = blade.poseAt(0.93 * k / 50, WingSide::LEFT);
    ASSERT_TRUE(pose);
    for (const Triangle& panel : pose->panels) {
      EXPECT_NEAR((panel[1] - panel[0]).norm(), blade.edgeLength(), 1e-12);
      EXPECT_NEAR((panel[2] - panel[0]).norm(), blade.edgeLength(), 1e-12);
      EXPECT_NEAR(angleBetween(panel[1] - panel[0], panel[2] - panel[0]), blade.panelAngle(), 1e-7);
    }
    EXPECT_LT((pose->edges[0] - pose->tip).norm(), 1e-12);
    EXPECT_NEAR(angleBetween(pose->edges[0] - pose->joint2, pose->edges[4] - pose->joint2), pose->span, 1e-9);
    // It closes up to the second equilibrium; in the dwell after it, it stays as good as closed.
    if (0.93 * k / 50 <= 0.83)
      EXPECT_LT(pose->span, last);
    else
      EXPECT_LT(pose->span, layout().blade.folded_span + 0.05);
    last = pose->span;
  }
  EXPECT_NEAR(blade.poseAt(0.93, WingSide::LEFT)->span, layout().blade.folded_span, 1e-9);
  EXPECT_GT(blade.poseAt(0, WingSide::LEFT)->span, 1.5);
}

TEST(WingBlade, RightIsTheMirrorOfLeft) {
  const WingBlade blade(layout());
  const auto left = blade.poseAt(0.5, WingSide::LEFT), right = blade.poseAt(0.5, WingSide::RIGHT);
  const Eigen::DiagonalMatrix<double, 3> mirror(1, -1, 1);
  for (int i = 0; i < 4; ++i) {
    for (int c = 0; c < 3; ++c) EXPECT_EQ(mirror * left->panels[i][c], right->panels[i][c]);
  }
  EXPECT_GT(left->tip.y(), 0);
  const MassProperties a = blade.massAt(*left), b = blade.massAt(*right);
  EXPECT_NEAR(a.mass, b.mass, 1e-15);
  EXPECT_LT((mirror * a.centre - b.centre).norm(), 1e-14);
  EXPECT_LT((mirror * a.inertia * mirror - b.inertia).norm(), 1e-16);
}

TEST(WingBlade, AxleIsWhereTheVehicleHasIt) {
  const WingLayout w = layout();
  const auto pose = WingBlade(w).poseAt(0, WingSide::LEFT);
  EXPECT_LT((pose->axle - Vector3d(0, 0.045 + 0.078, -0.020)).norm(), 1e-12);
  EXPECT_LT((pose->joint1 - Vector3d(0, 0.123 + w.linkage.joint1.x(), w.linkage.joint1.y() - 0.020)).norm(), 1e-12);
}

TEST(WingBlade, MassIsTheSumOfItsPartsAndInertiaMatchesPoints) {
  const WingBlade blade(layout());
  const WingLayout& w = blade.layout();
  const auto pose = blade.poseAt(0.4, WingSide::LEFT);
  const double L = blade.edgeLength();
  const double film = 4 * 0.5 * L * L * std::sin(blade.panelAngle()) * w.blade.film_density * w.blade.film_thickness;
  const double ribs = 2 * w.blade.rib_density * w.blade.rib_width * w.blade.rib_thickness * L;
  const double rod = w.blade.rod_density * M_PI / 4 * 0.008 * 0.008 * L;
  const double bars = w.bars.mass_density * w.bars.width * w.bars.thickness *
                      (w.linkage.crankLength() + w.linkage.couplerLength() + w.linkage.rockerLength());
  const MassProperties mass = blade.massAt(*pose);
  EXPECT_NEAR(mass.mass, film + ribs + rod + bars, 1e-12);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(mass.inertia);
  const Vector3d& I = eigen.eigenvalues();
  EXPECT_GT(I[0], 0);
  EXPECT_LE(I[2], I[0] + I[1] + 1e-15);
  // Only the rod: heavy by far, so that the whole is a uniform thin rod about its middle.
  WingLayout heavy = w;
  heavy.blade.rod_density = 1e9;
  const MassProperties rod_only = WingBlade(heavy).massAt(*pose);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> thin(rod_only.inertia);
  EXPECT_NEAR(thin.eigenvalues()[2], rod_only.mass * L * L / 12, 1e-5 * rod_only.mass * L * L);
}

TEST(WingBlade, FrictionForceIsTheWorkOfThePinsPerTravel) {
  WingLayout w = layout();
  w.bars.friction_unevenness = 0.25;
  const WingBlade blade(w);
  const double slope = 12, left = *blade.frictionForce(0.5, slope, WingSide::LEFT);
  EXPECT_NEAR(left / *blade.frictionForce(0.5, slope, WingSide::RIGHT), 1.25 / 0.75, 1e-12);
  const double h = 1e-5;
  const auto high = poseAt(w.linkage, 0.5 + h), low = poseAt(w.linkage, 0.5 - h);
  const double wing = (high->wing_rotation - low->wing_rotation) / (2 * h);
  const double rocker = (high->rocker_rotation - low->rocker_rotation) / (2 * h);
  const double sum = 1 + std::abs(wing - 1) + std::abs(wing - rocker) + std::abs(rocker);
  EXPECT_NEAR(left, 1.25 * w.bars.friction_moment * sum * slope, 1e-8 * left);
}

TEST(WingLayout, FileRoundTripKeepsEveryBit) {
  const WingLayout w = layout();
  const std::string path = temporary("wing.yaml");
  saveWing(w, paperSettings(), paperDesign(), {}, path);
  const WingLayout back = loadWing(path);
  EXPECT_EQ(back.linkage.joint1, w.linkage.joint1);
  EXPECT_EQ(back.linkage.joint2, w.linkage.joint2);
  EXPECT_EQ(back.linkage.tip, w.linkage.tip);
  EXPECT_EQ(back.anchor, w.anchor);
  EXPECT_EQ(back.arm_rotation, w.arm_rotation);
  EXPECT_EQ(back.bars.friction_moment, w.bars.friction_moment);
  EXPECT_EQ(back.blade.film_thickness, w.blade.film_thickness);
  EXPECT_EQ(back.axle_radius, w.axle_radius);
  std::ofstream(path, std::ios::app) << "surprise: 1\n";
  EXPECT_THROW(loadWing(path), common::SettingError);
}

TEST(WingLayout, AnUnfinishedDesignIsRefused) {
  WingDesign design = paperDesign();
  design.status = WingStatus::INFEASIBLE;
  const WingSettings settings = paperSettings();
  EXPECT_THROW(layoutOf(settings, design, vehicle::loadVehicle(settings.vehicle_file), "rigid"), common::Error);
}

TEST(WingTable, FollowsThePosesAndSurvivesTheFile) {
  const WingSettings settings = paperSettings();
  const auto table = tabulate(paperDesign().linkage, *settings.motion, 0.070, 141);
  ASSERT_TRUE(table);
  EXPECT_TRUE(table->stored_energy.empty());
  EXPECT_NEAR(table->arm_rotation.back(), 0.93, 1e-12);
  for (std::size_t i = 1; i + 1 < table->travel.size(); ++i) {
    const double slope = (table->wing_angle[i + 1] - table->wing_angle[i - 1]) / 1e-3;
    EXPECT_NEAR(table->angle_per_travel[i], slope, 0.02 * std::abs(slope) + 1.5);
    EXPECT_GT(table->transmission_angle[i], 0.24);
  }
  const std::string path = temporary("wing_table.h5");
  saveWingTable(*table, path);
  const WingTable back = loadWingTable(path);
  EXPECT_EQ(back.tip_x, table->tip_x);
  EXPECT_EQ(back.transmission_ratio, table->transmission_ratio);
  EXPECT_TRUE(back.stored_energy.empty());
  EXPECT_EQ(back.provenance, table->provenance);
  std::ofstream(path) << "no table";
  EXPECT_THROW(loadWingTable(path), common::FileError);
}

TEST(WingTable, NoneWhereTheLoopOpens) {
  FourBar bar = paperDesign().linkage;
  bar.joint2 = {0.05, 0.0};
  const ArmMotion motion({0, 0.05, 0.1}, {0, 1.5, 3.1}, "test");
  ASSERT_FALSE(checkTravel(bar, 3.1).closes);
  EXPECT_FALSE(tabulate(bar, motion, 0.1, 50));
}

}  // namespace
}  // namespace snapwing::design
