// The rigid four-bar: geometry kept, both assembly modes, dead points, derivatives.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "snapwing/common/error.h"
#include "snapwing/design/wing/linkage_four_bar.h"

namespace snapwing::design {
namespace {

using Eigen::Vector2d;

FourBar example() {
  FourBar bar;
  bar.joint1 = {0.0775, -0.0068};
  bar.joint2 = {0.0634, -0.0020};
  bar.tip = {0.155, 0.020};
  return bar;
}

/// Layouts that close over the travel; the count of tries is bounded, so that a broken check cannot hang the test.
std::vector<FourBar> randomLayouts(int count, double largest, std::mt19937* rng) {
  std::uniform_real_distribution<double> place(-0.08, 0.09);
  std::vector<FourBar> found;
  for (int i = 0; i < 20000 && static_cast<int>(found.size()) < count; ++i) {
    FourBar bar = example();
    bar.joint1 = {place(*rng), place(*rng)};
    bar.joint2 = {place(*rng), place(*rng)};
    bar.crank_sign = i % 2 ? 1 : -1;
    if (bar.crankLength() < 5e-3 || bar.couplerLength() < 5e-3 || bar.rockerLength() < 5e-3) continue;
    const TravelCheck check = checkTravel(bar, largest);
    if (check.closes && check.smallest_transmission > 0.1) found.push_back(bar);
  }
  return found;
}

TEST(LinkageFourBar, RestIsRest) {
  const auto pose = poseAt(example(), 0);
  ASSERT_TRUE(pose);
  EXPECT_LT((pose->joint1 - example().joint1).norm(), 1e-15);
  EXPECT_LT((pose->joint2 - example().joint2).norm(), 1e-14);
  EXPECT_LT((pose->tip - example().tip).norm(), 1e-14);
  EXPECT_NEAR(pose->wing_rotation, 0, 1e-13);
  EXPECT_NEAR(pose->rocker_rotation, 0, 1e-13);
}

TEST(LinkageFourBar, BarsKeepTheirLengthsAndRotationsAreContinuous) {
  std::mt19937 rng(7);
  const double largest = 3.0;
  const auto layouts = randomLayouts(40, largest, &rng);
  ASSERT_EQ(layouts.size(), 40u);
  for (const FourBar& bar : layouts) {
    FourBarPose last = *poseAt(bar, 0);
    for (int k = 1; k <= 600; ++k) {
      const double theta = largest * k / 600;
      const auto pose = poseAt(bar, theta);
      ASSERT_TRUE(pose) << theta;
      EXPECT_NEAR((pose->joint2 - pose->joint1).norm(), bar.couplerLength(), 1e-14);
      EXPECT_NEAR((pose->joint2 - bar.auxiliary).norm(), bar.rockerLength(), 1e-14);
      EXPECT_NEAR((pose->tip - pose->joint1).norm(), (bar.tip - bar.joint1).norm(), 1e-14);
      EXPECT_NEAR((pose->tip - pose->joint2).norm(), (bar.tip - bar.joint2).norm(), 1e-13);
      // The rotation is the one that carries the rest coupler and rocker to where they are.
      const Eigen::Rotation2Dd wing(pose->wing_rotation), rocker(pose->rocker_rotation);
      EXPECT_LT((wing * (bar.joint2 - bar.joint1) - (pose->joint2 - pose->joint1)).norm(), 1e-13);
      EXPECT_LT((rocker * (bar.joint2 - bar.auxiliary) - (pose->joint2 - bar.auxiliary)).norm(), 1e-13);
      EXPECT_LT(std::abs(pose->wing_rotation - last.wing_rotation), 0.5) << theta;
      EXPECT_LT(std::abs(pose->rocker_rotation - last.rocker_rotation), 0.5) << theta;
      EXPECT_EQ(bar.branchOf(pose->joint1, pose->joint2), bar.branch());
      last = *pose;
    }
  }
}

TEST(LinkageFourBar, ParallelogramTranslatesItsCoupler) {
  FourBar bar;
  bar.auxiliary = {0.035, 0};
  bar.joint1 = {0.004, 0.020};
  bar.joint2 = {0.039, 0.020};
  bar.tip = {0.100, 0.050};
  const auto pose = poseAt(bar, 0.9);
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->wing_rotation, 0, 1e-14);
  EXPECT_NEAR(pose->rocker_rotation, 0.9, 1e-14);
  EXPECT_NEAR(pose->wing_rate, 0, 1e-13);
  EXPECT_NEAR(pose->rocker_rate, 1, 1e-13);
}

TEST(LinkageFourBar, RatesAreTheDerivativesOfTheRotations) {
  const FourBar bar = example();
  for (const double theta : {0.05, 0.4, 0.83, 0.93}) {
    const auto pose = poseAt(bar, theta);
    ASSERT_TRUE(pose);
    const double h = 1e-5;
    const auto high = poseAt(bar, theta + h), low = poseAt(bar, theta - h);
    EXPECT_NEAR((high->wing_rotation - low->wing_rotation) / (2 * h), pose->wing_rate, 1e-7);
    EXPECT_NEAR((high->rocker_rotation - low->rocker_rotation) / (2 * h), pose->rocker_rate, 1e-7);
  }
}

/// All outputs in one vector: joint1, joint2, tip [m], rotations [rad], sine, rates.
Eigen::Matrix<double, 11, 1> outputs(const FourBarPose& p) {
  Eigen::Matrix<double, 11, 1> all;
  all << p.joint1, p.joint2, p.tip, p.wing_rotation, p.rocker_rotation, p.transmission_sine, p.wing_rate, p.rocker_rate;
  return all;
}

FourBar shifted(FourBar bar, int variable, double by) {
  (variable < 2 ? bar.joint1 : bar.joint2)[variable % 2] += by;
  return bar;
}

void expectSlopes(const FourBar& bar, double theta) {
  const auto s = sensitivityAt(bar, theta);
  ASSERT_TRUE(s);
  Eigen::Matrix<double, 11, 4> exact;
  exact << s->joint1, s->joint2, s->tip, s->wing_rotation, s->rocker_rotation, s->transmission_sine, s->wing_rate,
      s->rocker_rate;
  double errors[3];
  int n = 0;
  for (const double step : {1e-4, 1e-5, 1e-6}) {
    double worst = 0;
    for (int i = 0; i < 4; ++i) {
      const Eigen::Matrix<double, 11, 1> slope =
          (outputs(*poseAt(shifted(bar, i, step), theta)) - outputs(*poseAt(shifted(bar, i, -step), theta))) /
          (2 * step);
      worst = std::max(worst, (slope - exact.col(i)).cwiseAbs().maxCoeff() / exact.cwiseAbs().maxCoeff());
    }
    errors[n++] = worst;
  }
  EXPECT_LT(errors[1], 0.02 * errors[0] + 1e-8);
  EXPECT_LT(errors[2], 1e-6);
  EXPECT_GT(exact.rightCols<2>().cwiseAbs().maxCoeff(), 0.1);
}

TEST(LinkageFourBar, EveryDerivativeMatchesDifferences) {
  for (const double theta : {0.2, 0.83, 0.93}) expectSlopes(example(), theta);
  std::mt19937 rng(3);
  const auto layouts = randomLayouts(10, 0.93, &rng);
  ASSERT_EQ(layouts.size(), 10u);
  for (const FourBar& bar : layouts) expectSlopes(bar, 0.7);
}

TEST(LinkageFourBar, BothAssemblyModesCloseTheLoop) {
  std::mt19937 rng(11);
  for (const FourBar& bar : randomLayouts(10, 0.93, &rng)) {
    const auto modes = assemblyModes(bar, 0.6);
    ASSERT_EQ(modes.size(), 2u);
    EXPECT_EQ(bar.branchOf(modes[0].joint1, modes[0].joint2), bar.branch());
    EXPECT_EQ(bar.branchOf(modes[1].joint1, modes[1].joint2), -bar.branch());
    for (const FourBarPose& pose : modes) {
      EXPECT_NEAR((pose.joint2 - pose.joint1).norm(), bar.couplerLength(), 1e-13);
      EXPECT_NEAR((pose.joint2 - bar.auxiliary).norm(), bar.rockerLength(), 1e-13);
      EXPECT_NEAR((pose.tip - pose.joint2).norm(), (bar.tip - bar.joint2).norm(), 1e-13);
      const Eigen::Rotation2Dd wing(pose.wing_rotation);
      EXPECT_LT((wing * (bar.joint2 - bar.joint1) - (pose.joint2 - pose.joint1)).norm(), 1e-13);
    }
    const FourBar other = otherAssembly(bar);
    EXPECT_EQ(other.branch(), -bar.branch());
    EXPECT_LT((poseAt(other, 0.6)->joint2 - modes[1].joint2).norm(), 1e-13);
  }
}

/// Crank 20, ground 40, coupler 30 and rocker such that the loop opens when the crank points away from B.
FourBar opening() {
  FourBar bar;
  bar.auxiliary = {0.040, 0};
  bar.joint1 = {0.020, 0};
  bar.joint2 = {0.025, 0.0296};
  bar.tip = {0.1, 0.1};
  return bar;
}

TEST(LinkageFourBar, DeadPointIsFoundWhereTheLoopOpens) {
  FourBar bar = opening();
  bar.joint2 = {0.020 + 0.02 * std::cos(1.2), 0.02 * std::sin(1.2)};
  // Bars 20 (coupler) and |X2 - B|; crank on the ground bar at rest, so D grows from 20 mm with theta.
  const double a = bar.couplerLength(), b = bar.rockerLength();
  const double reach = a + b, c = 0.020, g = 0.040;
  const double expected = std::acos((c * c + g * g - reach * reach) / (2 * c * g));
  const TravelCheck check = checkTravel(bar, 2.5);
  EXPECT_FALSE(check.closes);
  EXPECT_NEAR(check.dead_point, expected, 1e-12);
  EXPECT_GT(check.largest_bar_mismatch, 0);
  EXPECT_TRUE(poseAt(bar, expected - 1e-6));
  EXPECT_FALSE(poseAt(bar, expected + 1e-6));
  EXPECT_TRUE(assemblyModes(bar, expected + 1e-6).empty());
  EXPECT_NE(check.verdict(0.2).find("dead point"), std::string::npos);
  const TravelCheck before = checkTravel(bar, expected - 1e-3);
  EXPECT_TRUE(before.closes);
  EXPECT_TRUE(std::isnan(before.dead_point));
  EXPECT_NE(before.verdict(0.2).find("falls to"), std::string::npos);
}

TEST(LinkageFourBar, SmallestTransmissionAngleIsTheMinimumOfASweep) {
  std::mt19937 rng(5);
  for (const FourBar& bar : randomLayouts(30, 1.5, &rng)) {
    const TravelCheck check = checkTravel(bar, 1.5);
    double least = 10;
    for (int k = 0; k <= 3000; ++k) {
      least = std::min(least, std::asin(std::min(1.0, std::abs(poseAt(bar, 1.5 * k / 3000)->transmission_sine))));
    }
    EXPECT_NEAR(check.smallest_transmission, least, 1e-5);
  }
}

TEST(LinkageFourBar, NonsenseIsRefusedByName) {
  FourBar bar = example();
  bar.joint2 = bar.joint1;
  EXPECT_THROW(bar.validate(), common::Error);
  bar = example();
  bar.joint2 = bar.auxiliary;
  try {
    bar.validate();
    FAIL();
  } catch (const common::Error& e) {
    EXPECT_NE(std::string(e.what()).find("rocker"), std::string::npos);
  }
  bar = example();
  bar.joint1.x() = std::nan("");
  EXPECT_THROW(bar.validate(), common::Error);
  bar = example();
  bar.crank_sign = 0;
  EXPECT_THROW(bar.validate(), common::Error);
  bar = example();
  bar.joint2 = 0.5 * (bar.joint1 + bar.auxiliary);
  EXPECT_THROW(bar.validate(), common::Error);
  EXPECT_THROW(checkTravel(example(), 0), common::Error);
}

}  // namespace
}  // namespace snapwing::design
