#pragma once
/// What every elastic rung of the linkage must show: the stiffness ladder, both drives, layouts that do not close.

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <vector>

#include "snapwing/design/wing/linkage_model.h"
#include "wing_example.h"

namespace snapwing::design {

constexpr double ARM_MODULUS = 5.5e6;  ///< [Pa] what "10 to 1e5 times stiffer than the arm" refers to

inline WingBars barsOf(double modulus) {
  WingBars bars = paperSettings().bars;
  bars.youngs_modulus = modulus;
  return bars;
}

using TestedRung = std::function<std::unique_ptr<LinkageModel>(const FourBar& layout, const WingBars& bars)>;

inline ElasticState solvedOn(const TestedRung& rung, const FourBar& layout, const WingBars& bars, double theta) {
  const ElasticState state = rung(layout, bars)->solve(theta);
  EXPECT_EQ(state.status, ElasticStatus::CONVERGED) << state.message;
  return state;
}

inline void expectLadder(const TestedRung& rung, const FourBar& layout, double theta) {
  double last = 0;
  for (const double factor : {1e1, 1e2, 1e3, 1e4, 1e5}) {
    const ElasticState state = solvedOn(rung, layout, barsOf(factor * ARM_MODULUS), theta);
    ASSERT_EQ(state.status, ElasticStatus::CONVERGED);
    EXPECT_TRUE(state.stable);
    EXPECT_EQ(layout.branchOf(state.joint1, state.joint2), layout.branch());
    const double error = (state.tip - poseAt(layout, theta)->tip).norm();
    EXPECT_GT(error, 0);
    if (last > 0) {
      EXPECT_NEAR(last / error, 10, factor > 1e2 ? 0.5 : 4);  // first order in 1 / stiffness
    }
    last = error;
  }
  EXPECT_LT(last, 1e-6);
}

inline void expectLaddersOfPaperAndRandomLayouts(const TestedRung& rung) {
  for (const double theta : {0.3, 0.83, 0.93}) expectLadder(rung, paperDesign().linkage, theta);
  for (const FourBar& layout : randomFeasible(3, 0.93, 0.3, 17)) expectLadder(rung, layout, 0.83);
}

inline void expectSameEquilibria(const TestedRung& multipliers, const TestedRung& augmented) {
  for (const double modulus : {1e2 * ARM_MODULUS, 3e9}) {
    const ElasticState a = solvedOn(multipliers, paperDesign().linkage, barsOf(modulus), 0.93);
    const ElasticState b = solvedOn(augmented, paperDesign().linkage, barsOf(modulus), 0.93);
    ASSERT_EQ(a.q.size(), b.q.size());
    EXPECT_LT((a.q - b.q).cwiseAbs().maxCoeff(), 1e-8);
    EXPECT_LT((a.forces - b.forces).norm(), 1e-3 * a.forces.norm());
    EXPECT_GT(a.forces.norm(), 1e-3);
  }
}

/// Followed past the dead point of a layout that does not close.
inline void expectEnergyThatGrowsWithStiffness(const TestedRung& rung) {
  FourBar bar = paperDesign().linkage;
  bar.joint2 = {0.05, 0.0};
  const TravelCheck check = checkTravel(bar, 2.0);
  ASSERT_FALSE(check.closes);
  std::vector<double> thetas;
  for (double t = check.dead_point - 0.02; t < check.dead_point + 0.03; t += 0.005) thetas.push_back(t);
  double energy[2];
  for (int k = 0; k < 2; ++k) {
    WingBars bars = barsOf(k == 0 ? 1e8 : 2e8);
    bars.friction_moment = 0;  // near a dead point friction alone bends the bars
    const auto states = rung(bar, bars)->trace(thetas);
    ASSERT_EQ(states.back().status, ElasticStatus::CONVERGED) << states.back().message;
    energy[k] = states.back().energy;
    EXPECT_LT(states.front().energy, 1e-3 * states.back().energy);
  }
  EXPECT_NEAR(energy[1] / energy[0], 2, 0.1);
}

}  // namespace snapwing::design
