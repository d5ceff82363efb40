// Elastic linkage: beam anchors, both joint solvers, derivatives, the stiffness ladder, refusals.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "linkage_example.h"
#include "snapwing/common/error.h"
#include "snapwing/design/wing/linkage_elastic.h"
#include "snapwing/design/wing/wing_elastic_problem.h"

namespace snapwing::design {
namespace {

using Eigen::Vector4d;
using Eigen::VectorXd;

TestedRung beams(const ElasticSettings& settings = {}) {
  return [=](const FourBar& layout, const WingBars& bars) {
    return std::make_unique<ElasticLinkage>(layout, bars, settings);
  };
}

/// Small deterministic numbers around 0.
VectorXd wiggle(int size, double scale) {
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> number(-scale, scale);
  VectorXd v(size);
  for (int i = 0; i < size; ++i) v[i] = number(rng);
  return v;
}

TEST(ElasticLinkage, RigidMotionCostsNothing) {
  const FourBar bar = paperDesign().linkage;
  WingBars bars = barsOf(3e9);
  bars.friction_moment = 0;
  const ElasticState state = ElasticLinkage(bar, bars).solve(0.7);
  ASSERT_EQ(state.status, ElasticStatus::CONVERGED) << state.message;
  EXPECT_LT(state.energy, 1e-18);
  EXPECT_LT(state.constraint_residual, 1e-14);
  EXPECT_TRUE(state.stable);
  EXPECT_LT((state.tip - poseAt(bar, 0.7)->tip).norm(), 1e-12);
}

TEST(ElasticLinkage, EnergyDerivativesMatchDifferences) {
  const FourBar bar = paperDesign().linkage;
  ElasticSettings settings;
  settings.elements_per_bar = 2;
  const ElasticLinkage linkage(bar, barsOf(1e7), settings);
  // Far from rest: large rotations of neighbouring nodes and strains of some per cent.
  VectorXd q = wiggle(linkage.unknowns(), 3e-3);
  for (int i = 2; i < q.size(); i += 3) q[i] = 1.1 + 60 * q[i];
  const auto at = linkage.terms(q);
  double last = 0;
  for (const double step : {1e-4, 1e-5}) {
    double worst = 0;
    for (int i = 0; i < q.size(); ++i) {
      const VectorXd e = step * VectorXd::Unit(q.size(), i);
      const auto high = linkage.terms(q + e), low = linkage.terms(q - e);
      worst = std::max(worst, std::abs((high.energy - low.energy) / (2 * step) - at.gradient[i]) / at.gradient.norm());
      const VectorXd column = (high.gradient - low.gradient) / (2 * step) - at.hessian.col(i);
      worst = std::max(worst, column.norm() / at.hessian.norm());
    }
    if (last > 0) {
      EXPECT_LT(worst, 0.02 * last + 1e-9);
    }
    last = worst;
  }
  EXPECT_LT(last, 1e-6);
  EXPECT_LT((at.hessian - at.hessian.transpose()).norm(), 1e-12 * at.hessian.norm());
}

TEST(ElasticLinkage, DerivativesByTheLayoutMatchDifferencesAtFixedDisplacements) {
  const FourBar bar = paperDesign().linkage;
  ElasticSettings settings;
  settings.elements_per_bar = 3;
  const auto linkageAt = [&](const Vector4d& X) {
    FourBar moved = bar;
    moved.joint1 = X.head<2>();
    moved.joint2 = X.tail<2>();
    return ElasticLinkage(moved, barsOf(1e7), settings);
  };
  const Vector4d X = variablesOf(bar);
  const ElasticLinkage linkage = linkageAt(X);
  const VectorXd q = wiggle(linkage.unknowns(), 2e-3);
  const auto at = linkage.terms(q);
  for (int i = 0; i < 4; ++i) {
    const Vector4d e = 1e-6 * Vector4d::Unit(i);
    const auto high = linkageAt(X + e).terms(q), low = linkageAt(X - e).terms(q);
    EXPECT_NEAR((high.energy - low.energy) / 2e-6, at.by_X[i], 1e-6 * at.by_X.norm());
    EXPECT_LT(((high.gradient - low.gradient) / 2e-6 - at.mixed.col(i)).norm(), 1e-6 * at.mixed.norm());
  }
  EXPECT_GT(at.by_X.cwiseAbs().minCoeff(), 0);
}

TEST(ElasticLinkage, BendingOfABarMatchesTheCantilever) {
  // The leading edge as a cantilever: small end load by a ground pin would need a load case; the beam's own tangent
  // gives the compliance instead: clamp joint 2 and load the tip in the chain X2-tip.
  FourBar bar = paperDesign().linkage;
  bar.tip = bar.joint2 + Eigen::Vector2d(0.1, 0);
  ElasticSettings settings;
  settings.elements_per_bar = 40;
  const WingBars bars = barsOf(3e9);
  const ElasticLinkage linkage(bar, bars, settings);
  const auto at = linkage.terms(VectorXd::Zero(linkage.unknowns()));
  const int n = 3 * settings.elements_per_bar, first = linkage.tipIndex() + 3 - n;
  const Eigen::MatrixXd K = at.hessian.block(first, first, n, n);
  const VectorXd u = K.ldlt().solve(VectorXd::Unit(n, n - 2));
  const double EI = bars.youngs_modulus * bars.thickness * std::pow(bars.width, 3) / 12;
  const double GA = 5.0 / 6.0 * bars.youngs_modulus / (2 * (1 + bars.poisson_ratio)) * bars.width * bars.thickness;
  const double exact = 1e-3 / (3 * EI) + 0.1 / GA;
  EXPECT_NEAR(u[n - 2], exact, 2e-3 * exact);
}

TEST(ElasticLinkage, BothSolversAgree) {
  ElasticSettings augmented;
  augmented.solver = JointSolver::AUGMENTED_LAGRANGIAN;
  expectSameEquilibria(beams(), beams(augmented));
}

TEST(ElasticLinkage, StiffnessLadderConvergesToTheRigidRung) { expectLaddersOfPaperAndRandomLayouts(beams()); }

TEST(ElasticLinkage, MeshAndPlaceOfTheJointInItsElementDoNotMatter) {
  const FourBar bar = paperDesign().linkage;
  const WingBars bars = barsOf(1e2 * ARM_MODULUS);
  const auto tipWith = [&](int elements, double overhang) {
    ElasticSettings s;
    s.elements_per_bar = elements;
    s.overhang = overhang;
    const ElasticState state = ElasticLinkage(bar, bars, s).solve(0.83);
    EXPECT_EQ(state.status, ElasticStatus::CONVERGED) << state.message;
    return state.tip;
  };
  const Eigen::Vector2d fine = tipWith(48, 0);
  const double moved = (fine - poseAt(bar, 0.83)->tip).norm();
  EXPECT_LT((tipWith(24, 0) - fine).norm(), 0.01 * moved);             // joints on nodes: the cell's edge
  EXPECT_LT((tipWith(24, 0.25) - fine).norm(), 0.03 * moved);          // joints exactly on nodes within the bar
  EXPECT_LT((tipWith(24, 0.0801) - fine).norm(), 0.03 * moved);        // joints inside elements
  EXPECT_LT((tipWith(1, 0.1) - poseAt(bar, 0.83)->tip).norm(), 1e-3);  // both joints of the rocker in one element
}

TEST(ElasticLinkage, TooManyPointsOfOneElementAreRefusedWithAReason) {
  ElasticSettings settings;
  settings.elements_per_bar = 1;
  settings.ground_pins = {{2, 0, 0.3}, {2, 0, 0.6}};
  const ElasticState state = ElasticLinkage(paperDesign().linkage, barsOf(3e9), settings).solve(0.5);
  EXPECT_EQ(state.status, ElasticStatus::RANK_DEFICIENT);
  EXPECT_NE(state.message.find("rank"), std::string::npos);
  settings.ground_pins = {{0, 1, 1e-3}};  // beside the axle, in an element of its own: full rank, but it cannot turn
  settings.elements_per_bar = 6;
  const ElasticState stuck = ElasticLinkage(paperDesign().linkage, barsOf(3e9), settings).solve(0.5);
  EXPECT_NE(stuck.status, ElasticStatus::RANK_DEFICIENT);
  if (stuck.status == ElasticStatus::CONVERGED) {
    EXPECT_GT(stuck.energy, 1e-3);
  }
}

TEST(ElasticLinkage, DrivenPortOnTheAxleIsRefusedAndNearItIsSolved) {
  ElasticSettings settings;
  settings.driver_length = 0;
  EXPECT_THROW(ElasticLinkage(paperDesign().linkage, barsOf(3e9), settings), common::SettingError);
  settings.driver_length = 2e-3;
  const ElasticState near = ElasticLinkage(paperDesign().linkage, barsOf(3e9), settings).solve(0.5);
  EXPECT_EQ(near.status, ElasticStatus::CONVERGED) << near.message;
  EXPECT_LT((near.tip - poseAt(paperDesign().linkage, 0.5)->tip).norm(), 1e-4);
}

TEST(ElasticLinkage, BarsThatDoNotReachStoreEnergyThatGrowsWithStiffness) {
  expectEnergyThatGrowsWithStiffness(beams());
}

TEST(ElasticWingProblem, AdjointAndDirectGradientsMatchDifferences) {
  WingSettings settings = paperSettings();
  settings.dwell_weight = 0.05;
  settings.bars.youngs_modulus = 10 * ARM_MODULUS;  // soft, so that energy and bending count
  settings.bars.friction_moment = 2e-3;
  settings.compliance_weight = 100;
  const ElasticWingProblem problem(settings);
  // Away from the optimum, where the gradient vanishes and relative errors mean nothing.
  const Vector4d X = variablesOf(paperDesign().linkage) + Vector4d(1e-3, -2e-3, 1.5e-3, 1e-3);
  const double coarse = slopeError(problem, X, 1e-4), fine = slopeError(problem, X, 1e-5);
  EXPECT_LT(fine, 0.05 * coarse + 1e-8);
  EXPECT_LT(fine, 2e-5);
  const double rigid = RigidWingProblem(settings).evaluate(X, false).objective;
  EXPECT_GT(std::abs(problem.evaluate(X, false).objective - rigid), 1e-3 * rigid);
}

TEST(ElasticWingProblem, ElasticDesignOfThePaperStaysNearTheRigidOne) {
  WingSettings settings = paperSettings();
  settings.starts = 4;
  ElasticSettings elastic;
  elastic.elements_per_bar = 4;
  const WingDesign design = designWing(ElasticWingProblem(settings, beamRung(settings.bars, elastic)));
  ASSERT_EQ(design.status, WingStatus::DESIGNED) << design.message;
  // What the elastic rung adds to the objective is the compliance of state 2; the tips hardly move.
  const double energy = compareRungs(ElasticLinkage(design.linkage, settings.bars, elastic), {0.93}).largest_energy;
  const double compliance = settings.compliance_weight * energy;
  EXPECT_GT(compliance, 0);
  EXPECT_NEAR(design.objective - compliance, paperDesign().objective, 2e-3 * paperDesign().objective);
  EXPECT_LT((variablesOf(design.linkage) - variablesOf(paperDesign().linkage)).norm(), 2e-3);
}

TEST(ElasticWingProblem, StoredEnergyIsSmallAndTheBranchKept) {
  std::vector<double> thetas;
  for (int k = 0; k <= 40; ++k) thetas.push_back(0.93 * k / 40);
  const RungComparison c = compareRungs(ElasticLinkage(paperDesign().linkage, paperSettings().bars), thetas);
  ASSERT_TRUE(c.converged) << c.message;
  EXPECT_TRUE(c.same_branch);
  EXPECT_TRUE(c.stable);
  EXPECT_LT(c.largest_energy, 1e-5);     // [J]; the arms' barrier on the way back is 16 mJ for the vehicle
  EXPECT_LT(c.largest_tip_error, 1e-4);  // a thirtieth of the tip residual; most at rest, where the ratio is highest
  EXPECT_GT(c.largest_energy, 0);
}

}  // namespace
}  // namespace snapwing::design
