// The linkage as solids on the mpm layer: rigid limit, derivatives, joints, both solvers, ladder, refusals, 3-D.
#include <gtest/gtest.h>

#include <cmath>

#include "linkage_example.h"
#include "snapwing/common/error.h"
#include "snapwing/design/wing/wing_elastic_problem.h"

namespace snapwing::design {
namespace {

using Eigen::Vector4d;

TestedRung solids(const SolidSettings& settings = {}) {
  return [=](const FourBar& layout, const WingBars& bars) { return makeSolidLinkage(layout, bars, settings); };
}

ElasticState solved(const FourBar& layout, const WingBars& bars, double theta, const SolidSettings& settings = {}) {
  return solvedOn(solids(settings), layout, bars, theta);
}

FourBar moved(const FourBar& layout, const Vector4d& by) {
  FourBar other = layout;
  other.joint1 += by.head<2>();
  other.joint2 += by.tail<2>();
  return other;
}

TEST(SolidLinkage, RigidMotionCostsNothing) {
  WingBars bars = barsOf(3e9);
  bars.friction_moment = 0;
  for (const int dimension : {2, 3}) {
    SolidSettings settings;
    settings.dimension = dimension;
    const ElasticState state = solved(paperDesign().linkage, bars, 0.7, settings);
    const FourBarPose pose = *poseAt(paperDesign().linkage, 0.7);
    EXPECT_LT(std::abs(state.energy), 1e-16 * 3e9 * 1.6e-5);  // rounding of E times the volume
    EXPECT_LT((state.tip - pose.tip).norm(), 1e-10);
    EXPECT_NEAR(state.wing_rotation, pose.wing_rotation, 1e-9);
    EXPECT_TRUE(state.stable);
  }
}

/// Soft bars and much friction, so that bending counts.
WingBars softBars() {
  WingBars bars = barsOf(10 * ARM_MODULUS);
  bars.friction_moment = 2e-3;
  return bars;
}

/// Worst difference between the direct derivatives and central differences, relative to the largest of each quantity.
double stateSlopeError(const FourBar& layout, double theta, const SolidSettings& s, double step) {
  const auto linkage = makeSolidLinkage(layout, softBars(), s);
  const ElasticSensitivity slope = linkage->sensitivity(linkage->solve(theta));
  double worst = 0;
  for (int k = 0; k < 4; ++k) {
    const Vector4d e = step * Vector4d::Unit(k);
    const ElasticState high = solved(moved(layout, e), softBars(), theta, s),
                       low = solved(moved(layout, -e), softBars(), theta, s);
    const auto compare = [&](const Eigen::Vector2d& up, const Eigen::Vector2d& down, const auto& derivative) {
      worst = std::max(worst, ((up - down) / (2 * step) - derivative.col(k)).norm() / derivative.norm());
    };
    compare(high.joint1, low.joint1, slope.joint1);
    compare(high.joint2, low.joint2, slope.joint2);
    compare(high.tip, low.tip, slope.tip);
    worst = std::max(worst, std::abs((high.wing_rotation - low.wing_rotation) / (2 * step) - slope.wing_rotation[k]) /
                                slope.wing_rotation.norm());
    worst = std::max(worst, std::abs((high.energy - low.energy) / (2 * step) - slope.energy[k]) / slope.energy.norm());
  }
  EXPECT_GT(slope.energy.norm(), 0);
  return worst;
}

TEST(SolidLinkage, DerivativesThroughTheSaddlePointMatchDifferences) {
  const FourBar layout = moved(paperDesign().linkage, {1e-3, -2e-3, 1.5e-3, 1e-3});
  for (const int dimension : {2, 3}) {
    SolidSettings settings;
    settings.dimension = dimension;
    settings.cells_along = dimension == 2 ? 8 : 4;
    settings.cells_through = 1;
    const double coarse = stateSlopeError(layout, 0.9, settings, 1e-4),
                 fine = stateSlopeError(layout, 0.9, settings, 1e-5),
                 finest = stateSlopeError(layout, 0.9, settings, 1e-6);
    EXPECT_LT(fine, 0.02 * coarse);  // second order
    EXPECT_LT(std::min(fine, finest), 1e-6);
  }
}

TEST(SolidLinkage, AdjointAgreesWithDirectDerivatives) {
  const auto linkage = makeSolidLinkage(paperDesign().linkage, softBars());
  const ElasticState state = linkage->solve(0.83);
  const ElasticSensitivity s = linkage->sensitivity(state);
  StateSlopes L;
  L.joint1 = {0.3, -1.2};
  L.joint2 = {-0.7, 0.4};
  L.tip = {1.1, 0.9};
  L.wing_rotation = 0.05;
  L.energy = 20;
  const Vector4d direct = (L.joint1.transpose() * s.joint1 + L.joint2.transpose() * s.joint2 +
                           L.tip.transpose() * s.tip + L.wing_rotation * s.wing_rotation + L.energy * s.energy)
                              .transpose();
  EXPECT_LT((linkage->gradient(state, L) - direct).norm(), 1e-9 * direct.norm());
}

TEST(SolidLinkage, BothSolversAgree) {
  SolidSettings augmented;
  augmented.solver = JointSolver::AUGMENTED_LAGRANGIAN;
  augmented.max_iterations = 400;
  expectSameEquilibria(solids(), solids(augmented));
}

TEST(SolidLinkage, StiffnessLadderConvergesToTheRigidRung) { expectLaddersOfPaperAndRandomLayouts(solids()); }

TEST(SolidLinkage, JointOnACellsEdgeAndTwoJointsInOneCellAreSolved) {
  SolidSettings edge;
  edge.overhang = 0.1;  // 12 cells over 1.2 lengths: joints of coupler, edge and rocker on faces between cells
  edge.driver = 0.9;
  expectLadder(solids(edge), paperDesign().linkage, 0.83);
  SolidSettings one;
  one.cells_along = 1;  // both joints of each bar in one cell
  one.cells_across = 1;
  expectLadder(solids(one), paperDesign().linkage, 0.83);
}

TEST(SolidLinkage, DependentJointsAreRefusedWithAReason) {
  SolidSettings settings;
  settings.ground_pins = {{0, 0, 1e-10}};  // on the axle
  const ElasticState refused = makeSolidLinkage(paperDesign().linkage, barsOf(3e9), settings)->solve(0.5);
  EXPECT_EQ(refused.status, ElasticStatus::RANK_DEFICIENT);
  EXPECT_NE(refused.message.find("'axle'"), std::string::npos) << refused.message;
  EXPECT_NE(refused.message.find("ground pin 0"), std::string::npos) << refused.message;
  settings = {};
  settings.driver = 1e-9;  // the port on the axle
  const ElasticState port = makeSolidLinkage(paperDesign().linkage, barsOf(3e9), settings)->solve(0.5);
  EXPECT_EQ(port.status, ElasticStatus::RANK_DEFICIENT);
  EXPECT_NE(port.message.find("driven port"), std::string::npos) << port.message;
  settings.driver = 0.03;  // near it: solved
  const ElasticState near = solved(paperDesign().linkage, barsOf(3e9), 0.5, settings);
  EXPECT_LT((near.tip - poseAt(paperDesign().linkage, 0.5)->tip).norm(), 5e-4);
}

/// How far the tip is from the rigid rung where the transmission ratio is high: the scale of differences of rungs. A
/// point joint's own compliance grows with every refinement by the same amount (a line load on a solid), which is most
/// of what differs.
constexpr double STEEP = 0.3;

TEST(SolidLinkage, ExtrudedBarsWithSegmentsMatchThePlanarOnes) {
  SolidSettings volumetric;
  volumetric.dimension = 3;
  const WingBars bars = barsOf(1e2 * ARM_MODULUS);
  const FourBar layout = paperDesign().linkage;
  const double scale = (solved(layout, bars, STEEP).tip - poseAt(layout, STEEP)->tip).norm();
  for (const double theta : {STEEP, 0.83}) {
    const ElasticState planar = solved(layout, bars, theta), solid = solved(layout, bars, theta, volumetric);
    EXPECT_LT((solid.tip - planar.tip).norm(), 0.03 * scale);
    EXPECT_NEAR(solid.energy, planar.energy, 0.05 * planar.energy);
  }
}

TEST(SolidLinkage, AgreesWithTheBeams) {
  const WingBars bars = barsOf(1e3 * ARM_MODULUS);
  const FourBar layout = paperDesign().linkage;
  const double scale = (solved(layout, bars, STEEP).tip - poseAt(layout, STEEP)->tip).norm();
  ElasticSettings beams;
  beams.driver_length = 0.8 * layout.crankLength();  // where the solids' port is
  for (const double theta : {STEEP, 0.83}) {
    const ElasticState beam = ElasticLinkage(layout, bars, beams).solve(theta), solid = solved(layout, bars, theta);
    EXPECT_LT((solid.tip - beam.tip).norm(), 0.05 * scale);
    EXPECT_NEAR(solid.energy, beam.energy, 0.1 * beam.energy);
  }
}

TEST(SolidLinkage, BarsThatDoNotReachStoreEnergyThatGrowsWithStiffness) {
  expectEnergyThatGrowsWithStiffness(solids());
}

TEST(SolidWingProblem, GradientOfThePapersProblemMatchesDifferences) {
  WingSettings settings = paperSettings();
  settings.bars = softBars();
  settings.compliance_weight = 100;
  SolidSettings solid;
  solid.cells_along = 8;
  const ElasticWingProblem problem(settings, solidRung(settings.bars, solid));
  const Vector4d X = variablesOf(moved(paperDesign().linkage, {1e-3, -2e-3, 1.5e-3, 1e-3}));
  const double coarse = slopeError(problem, X, 1e-4), fine = slopeError(problem, X, 1e-5),
               finest = slopeError(problem, X, 1e-6);
  EXPECT_LT(fine, 0.02 * coarse);  // second order
  EXPECT_LT(finest, 1e-6);
}

TEST(SolidWingProblem, DesignOfThePaperStaysNearTheRigidOne) {
  WingSettings settings = paperSettings();
  settings.starts = 1;
  SolidSettings solid;
  solid.cells_along = 6;
  solid.cells_across = 1;
  const WingDesign design = designWing(ElasticWingProblem(settings, solidRung(settings.bars, solid)));
  ASSERT_EQ(design.status, WingStatus::DESIGNED) << design.message;
  EXPECT_LT((variablesOf(design.linkage) - variablesOf(paperDesign().linkage)).norm(), 2e-3);
}

}  // namespace
}  // namespace snapwing::design
