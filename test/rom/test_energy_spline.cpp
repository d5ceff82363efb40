#include <gtest/gtest.h>

#include <cmath>

#include "snapwing/common/error.h"
#include "snapwing/rom/energy_spline.h"
#include "support/example_table.h"

namespace snapwing::rom {
namespace {

using snapwing::testing::exampleTable;

TEST(EnergySpline, ExactAtTheKnots) {
  const vehicle::ForceTable table = exampleTable();
  const EnergySpline spline(table, 1.1);
  for (std::size_t i = 0; i < table.travel.size(); ++i) {
    const PotentialSample s = spline.at(table.travel[i]);
    EXPECT_NEAR(s.energy, 4.4 * table.energy[i], 1e-12);
    EXPECT_NEAR(s.force, 4.4 * table.force[i], 1e-10);
    EXPECT_NEAR(s.stiffness, 4.4 * table.stiffness[i], 1e-7);
  }
}

// Central differences: the error falls with the square of the step until rounding takes over.
TEST(EnergySpline, ForceAndStiffnessAreTheDerivatives) {
  const EnergySpline spline(exampleTable());
  double worst[3] = {0, 0, 0}, worst_k[3] = {0, 0, 0};
  const double steps[3] = {1e-4, 2.5e-5, 6.25e-6};
  for (double u = -0.0203; u < 0.0871; u += 0.00137) {
    for (int i = 0; i < 3; ++i) {
      const double h = steps[i];
      const double force = (spline.energy(u + h) - spline.energy(u - h)) / (2 * h);
      const double stiffness = (spline.at(u + h).force - spline.at(u - h).force) / (2 * h);
      worst[i] = std::max(worst[i], std::abs(force - spline.at(u).force));
      worst_k[i] = std::max(worst_k[i], std::abs(stiffness - spline.at(u).stiffness));
    }
  }
  EXPECT_GT(worst[2], 0.0);
  EXPECT_NEAR(worst[0] / worst[1], 16.0, 4.0);
  EXPECT_NEAR(worst[1] / worst[2], 16.0, 4.0);
  EXPECT_LT(worst[2], 1e-5);  // [N] of 4
  // The stiffness has kinks at the knots: first order there.
  EXPECT_LT(worst_k[1], worst_k[0] / 3.0);
  EXPECT_LT(worst_k[2], worst_k[1] / 3.0);
}

TEST(EnergySpline, EnergyIsTheIntegralOfTheForce) {
  const EnergySpline spline(exampleTable());
  // Simpson's rule between the two equilibria.
  const double a = 0.0, b = spline.equilibria().second;
  const int n = 4000;
  double sum = spline.at(a).force + spline.at(b).force;
  for (int i = 1; i < n; ++i) sum += (i % 2 ? 4.0 : 2.0) * spline.at(a + (b - a) * i / n).force;
  EXPECT_NEAR(sum * (b - a) / n / 3.0, spline.energy(b) - spline.energy(a), 1e-9);
}

TEST(EnergySpline, GoesOnSmoothlyAndStifferOutsideTheTable) {
  const EnergySpline spline(exampleTable());
  for (const double end : {spline.lowest(), spline.highest()}) {
    const PotentialSample in = spline.at(end + (end > 0 ? -1e-9 : 1e-9));
    const PotentialSample out = spline.at(end + (end > 0 ? 1e-9 : -1e-9));
    EXPECT_NEAR(in.energy, out.energy, 1e-6);
    EXPECT_NEAR(in.force, out.force, 1e-4);
    EXPECT_NEAR(in.stiffness, out.stiffness, 1e-2);
    EXPECT_FALSE(spline.inTable(end * 1.001));
    EXPECT_TRUE(spline.inTable(end));
  }
  EXPECT_GT(spline.at(0.1).stiffness, 2.0 * spline.at(0.08).stiffness);
  EXPECT_GT(spline.at(-0.03).stiffness, 2.0 * spline.at(-0.015).stiffness);
  EXPECT_LT(spline.at(-0.03).force, spline.at(-0.015).force);
}

TEST(EnergySpline, FindsTheStudysEquilibria) {
  const Equilibria e = EnergySpline(exampleTable()).equilibria();
  ASSERT_TRUE(e.bistable);
  EXPECT_NEAR(e.first, 0.0, 1e-9);
  EXPECT_NEAR(e.barrier, 0.02769, 2e-5);  // -.017268 at 28 mm, .039424 at 27
  EXPECT_NEAR(e.second, 0.05269, 2e-5);
  EXPECT_NEAR(e.peak_force, 4.0 * 1.025, 0.01);
  EXPECT_NEAR(e.valley_force, -4.0 * 0.5525, 0.01);
}

TEST(EnergySpline, ForceScaleScalesEverythingButTravel) {
  const EnergySpline one(exampleTable());
  const EnergySpline two = one.withForceScale(2.0);
  EXPECT_DOUBLE_EQ(two.at(0.013).force, 2.0 * one.at(0.013).force);
  EXPECT_DOUBLE_EQ(two.equilibria().barrier_second, 2.0 * one.equilibria().barrier_second);
  EXPECT_DOUBLE_EQ(two.equilibria().second, one.equilibria().second);
  EXPECT_DOUBLE_EQ(two.forceError(), 2.0 * one.forceError());
  EXPECT_THROW(one.withForceScale(0.0), common::Error);
  EXPECT_THROW(one.withForceScale(NAN), common::Error);
}

TEST(EnergySpline, ErrorEstimateSeesACoarseTable) {
  // The closed form R = 100 sin(100 u): the estimate of a table with spacing h must bound the true error of this table,
  // and shrink when the table is refined.
  const auto make = [](int n) {
    vehicle::ForceTable t;
    for (int i = 0; i <= n; ++i) {
      const double u = 0.08 * i / n;
      t.travel.push_back(u);
      t.force.push_back(std::sin(100 * u));
      t.stiffness.push_back(100 * std::cos(100 * u));
      t.energy.push_back((1 - std::cos(100 * u)) / 100);
      t.rotation.push_back(0);
      t.kinetic_mass.push_back(0);
      t.coupled_mass.push_back(0);
      t.min_det_f.push_back(1);
      t.stable.push_back(1);
      t.iterations.push_back(0);
    }
    return t;
  };
  const EnergySpline coarse(make(8)), fine(make(16));
  double error = 0;
  for (double u = 0; u < 0.08; u += 1e-4) error = std::max(error, std::abs(coarse.at(u).force - std::sin(100 * u)));
  EXPECT_GT(error, 1e-6);
  EXPECT_GE(coarse.forceError(), error);
  EXPECT_LT(fine.forceError(), coarse.forceError() / 8.0);
}

TEST(EnergySpline, UnevenKnotsGiveTheSameCurve) {
  vehicle::ForceTable even = exampleTable(), uneven = even;
  const auto drop = [](auto& list, std::size_t k) { list.erase(list.begin() + static_cast<std::ptrdiff_t>(k)); };
  for (const std::size_t k : {70u, 41u, 22u}) {
    drop(uneven.travel, k), drop(uneven.force, k), drop(uneven.stiffness, k), drop(uneven.energy, k);
    drop(uneven.rotation, k), drop(uneven.min_det_f, k), drop(uneven.stable, k), drop(uneven.iterations, k);
    drop(uneven.kinetic_mass, k), drop(uneven.coupled_mass, k);
  }
  const EnergySpline a(even), b(uneven);
  for (double u = -0.02; u < 0.09; u += 3.3e-4) EXPECT_NEAR(a.at(u).force, b.at(u).force, 0.01);
}

TEST(EnergySpline, RefusesBadTables) {
  vehicle::ForceTable table = exampleTable();
  EXPECT_THROW(EnergySpline(table, -1.0), common::Error);
  table.travel[3] = table.travel[2];
  EXPECT_THROW(EnergySpline{table}, common::Error);
}

}  // namespace
}  // namespace snapwing::rom
