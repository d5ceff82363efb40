/// Values in the limit of small cells, their error bars, and what a target says of them. All on made-up checks.
#include <gtest/gtest.h>

#include <cmath>

#include "arm_extrapolation.h"
#include "arm_judgement.h"

namespace snapwing::design {
namespace {

double peak(const ArmCheckCase& c) { return c.features.peak_force; }

/// A body of the given kernel whose peak is limit + slope h^order [N, mm].
ArmCheckCase body(const char* rung, double cell_mm, double limit, double slope, double order = 1) {
  ArmCheckCase c;
  c.rung = rung, c.name = std::to_string(cell_mm), c.cell_size = 1e-3 * cell_mm;
  c.traced = c.bistable = true;
  c.solid = std::string(rung) == VOLUMETRIC;
  c.features.peak_force = limit + slope * std::pow(cell_mm, order);
  c.features.valley_force = -1, c.features.second_travel = 0.052, c.rotation_second = 0.85;
  return c;
}

TEST(ArmExtrapolation, FirstOrderIsExactAndKernelsThatAgreeLeaveAThirdOfTheCorrection) {
  ArmCheck check;
  check.cases = {body(PLANAR_LINEAR, 1, 3.5, 0.2), body(PLANAR_LINEAR, 0.5, 3.5, 0.2),
                 body(PLANAR_QUADRATIC, 1, 3.5, 0.3), body(PLANAR_QUADRATIC, 0.5, 3.5, 0.3)};
  const ArmEstimate e = estimate(check, false, peak);
  EXPECT_NEAR(e.value, 3.5, 1e-12);
  EXPECT_NEAR(e.error, 0.15 / 3, 1e-12);  // the larger correction is that of the quadratic kernel: .3 * .5
}

TEST(ArmExtrapolation, ErrorBarHoldsTheTruthForOrdersFromPointEightOneToOnePointThree) {
  for (const double order : {0.81, 1.0, 1.15, 1.3}) {
    ArmCheck check;
    check.cases = {body(PLANAR_LINEAR, 0.5, 3.5, 0.2, order), body(PLANAR_LINEAR, 1, 3.5, 0.2, order)};
    const ArmEstimate e = estimate(check, false, peak);
    EXPECT_LE(std::abs(e.value - 3.5), e.error) << order;
  }
}

TEST(ArmExtrapolation, KernelsThatDisagreeWidenTheBarAndMovedOutlinesDoNotCount) {
  ArmCheck check;
  check.cases = {body(PLANAR_LINEAR, 1, 3.4, 0.01), body(PLANAR_LINEAR, 0.5, 3.4, 0.01),
                 body(PLANAR_QUADRATIC, 1, 3.6, 0.01), body(PLANAR_QUADRATIC, 0.5, 3.6, 0.01)};
  ArmCheckCase moved = body(PLANAR_LINEAR, 0.25, 9, 0);
  moved.offset = 2e-4;
  check.cases.push_back(moved);
  const ArmEstimate e = estimate(check, false, peak);
  EXPECT_NEAR(e.value, 3.5, 1e-12);
  EXPECT_NEAR(e.error, 0.1, 1e-12);
}

TEST(ArmExtrapolation, OneSizeAloneHasNoLimit) {
  ArmCheck check;
  check.cases = {body(PLANAR_LINEAR, 1, 3.5, 0.2)};
  EXPECT_TRUE(std::isnan(estimate(check, false, peak).value));
}

Verdict peakVerdict(std::vector<ArmCheckCase> cases) {
  ArmCheck check;
  check.cases = std::move(cases);
  check.complete = true;
  ArmTargets wanted;
  wanted.peak = {3.6, 4.0};
  judgeAll(wanted, check);
  EXPECT_EQ(check.targets.front().name, "peak force");
  return check.targets.front().verdict;
}

TEST(ArmJudgement, AValueThatPassesOnEveryGridFailsWhereItConvergesToLess) {
  EXPECT_EQ(peakVerdict({body(PLANAR_LINEAR, 1, 3.5, 0.3), body(PLANAR_LINEAR, 0.5, 3.5, 0.25)}), Verdict::NOT_MET);
  EXPECT_EQ(peakVerdict({body(PLANAR_LINEAR, 1, 3.8, 0.2), body(PLANAR_LINEAR, 0.5, 3.8, 0.2)}), Verdict::MET);
  // 3.61 +- .033: the bar reaches over the bound
  EXPECT_EQ(peakVerdict({body(PLANAR_LINEAR, 1, 3.61, 0.2), body(PLANAR_LINEAR, 0.5, 3.61, 0.2)}),
            Verdict::NOT_DECIDED);
}

TEST(ArmJudgement, SolidsOfTwoSizesAreJudgedTooAndABodyThatCouldNotBeTracedIsNoSuccess) {
  const std::vector<ArmCheckCase> planar = {body(PLANAR_LINEAR, 1, 3.8, 0.1), body(PLANAR_LINEAR, 0.5, 3.8, 0.1)};
  std::vector<ArmCheckCase> with_solid = planar, failed = planar;
  with_solid.push_back(body(VOLUMETRIC, 1.25, 3.3, 0.1));
  EXPECT_EQ(peakVerdict(with_solid), Verdict::MET) << "one size says nothing of the limit";
  with_solid.push_back(body(VOLUMETRIC, 0.625, 3.3, 0.1));
  EXPECT_EQ(peakVerdict(with_solid), Verdict::NOT_MET);
  failed[1].traced = false;
  EXPECT_EQ(peakVerdict(failed), Verdict::NOT_MET);
}

TEST(ArmExtrapolation, TableIsTheLimitOfBothCurvesPointByPoint) {
  ArmCheck check;
  for (const double cell : {1.0, 0.5}) {
    ArmCheckCase c = body(PLANAR_LINEAR, cell, 3.5, 0.2);
    for (int k = 0; k < 5; ++k) {
      c.table.travel.push_back(0.01 * k);
      c.table.force.push_back(k + cell), c.table.energy.push_back(2 * k + 3 * cell);
      c.table.stiffness.push_back(4), c.table.rotation.push_back(0.1 * k * cell);
      c.table.kinetic_mass.push_back(k + 2 * cell), c.table.coupled_mass.push_back(-k - cell);
      c.table.min_det_f.push_back(cell), c.table.stable.push_back(cell > 0.7 || k != 2);
      c.table.iterations.push_back(1);
    }
    c.table.mass = 10 + 0.001 * cell;
    check.cases.push_back(c);
  }
  const vehicle::ForceTable table = extrapolatedTable(check);
  ASSERT_EQ(table.travel.size(), 5U);
  EXPECT_NEAR(table.mass, 10, 1e-14);
  for (int k = 0; k < 5; ++k) {
    EXPECT_NEAR(table.force[k], k, 1e-14);
    EXPECT_NEAR(table.energy[k], 2 * k, 1e-14);
    EXPECT_NEAR(table.rotation[k], 0, 1e-14);
    EXPECT_NEAR(table.kinetic_mass[k], k, 1e-14);
    EXPECT_NEAR(table.coupled_mass[k], -k, 1e-14);
    EXPECT_EQ(table.stable[k], k != 2);
    EXPECT_EQ(table.min_det_f[k], 0.5);
    EXPECT_EQ(table.iterations[k], 2);
  }
  check.cases[0].table.travel[1] += 1e-4;
  EXPECT_TRUE(extrapolatedTable(check).travel.empty());
}

/// A push switch at .5 and .25 mm: each body's inertia is possible, the limits of its numbers alone were not.
TEST(ArmExtrapolation, InertiaInTheLimitIsThatOfAMotion) {
  ArmCheck check;
  for (const double cell : {0.5, 0.25}) {
    ArmCheckCase c = body(PLANAR_LINEAR, cell, 3.5, 0.2);
    c.table.travel = {0, 0.01}, c.table.force = {0, 1}, c.table.energy = {0, 0.005}, c.table.stiffness = {100, 100};
    c.table.rotation = {0, 0}, c.table.kinetic_mass = {1e-3, 2e-3 + 1e-3 * cell};
    c.table.coupled_mass = {1e-3, 2e-3}, c.table.mass = 1.9e-3 + 1e-3 * cell;
    c.table.min_det_f = {1, 1}, c.table.stable = {1, 1}, c.table.iterations = {1, 1};
    ASSERT_GE(c.table.kinetic_mass[1] * c.table.mass, 4e-6);
    check.cases.push_back(c);
  }
  const vehicle::ForceTable table = extrapolatedTable(check);
  EXPECT_NEAR(table.kinetic_mass[0], 1e-3, 1e-15);
  EXPECT_NEAR(table.kinetic_mass[1], 4e-6 / 1.9e-3, 1e-15);
}

}  // namespace
}  // namespace snapwing::design
