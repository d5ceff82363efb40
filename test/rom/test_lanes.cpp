// The curves in lanes against those that they were made of, beyond the tables too.
#include <gtest/gtest.h>

#include <cmath>

#include "ensemble_run.h"
#include "snapwing/rom/vehicle_curves.h"
#include "snapwing/vehicle/table_origin.h"
#include "support/paths.h"

#define SNAPWING_WIDTH tested
#define SNAPWING_NATIVE 2
#include "ensemble_motion.h"

namespace {

using namespace snapwing;
using rom::tested::Real;

TEST(Lanes, CurvesAreThoseOfThePotentialBeyondTheTableToo) {
  const auto vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  const auto table = vehicle::armTableOf(vehicle);
  const rom::VehicleCurves curves(table, vehicle::wingTableOf(vehicle, table));
  const rom::EnergySpline& spline = curves.spline();
  const rom::UniformCurves grid(spline, spline.lowest(), spline.highest(), curves.arms(), curves.wing());
  const rom::CurvesView view = grid.view();
  rom::LaneReals travels{};
  const double chosen[] = {-0.06, -0.03,  -0.0151, -0.004, 0.0005, 0.002,  0.0083, 0.0113,
                           0.013, 0.0297, 0.0467,  0.055,  0.0699, 0.0799, 0.083,  0.1};
  for (int l = 0; l < rom::LANES; ++l) travels.lane[l] = chosen[l];
  const Real u(travels);
  rom::EnsembleBlock block{};
  for (int l = 0; l < rom::LANES; ++l) {
    block.force_scale.lane[l] = 1;
    block.wing_inertia.lane[l] = 1.1;
    block.wing_friction.lane[l] = 0.7;
  }
  const rom::tested::Vehicles vehicles(block);
  const auto curve = rom::tested::curvesAt<true, true, true>(view, vehicles, u);
  const Real energy = rom::tested::energyAt<true, true>(view, vehicles, u, Real(2.0), Real(3.0));
  const rom::TravelInertia moved = *curves.arms() + curves.wing()->scaled(1.1, 0.7);
  for (int l = 0; l < rom::LANES; ++l) {
    const rom::PotentialSample truth = spline.at(chosen[l]);
    const rom::InertiaSample inertia = moved.at(chosen[l]);
    const double scale = std::abs(truth.force) + 1;
    EXPECT_NEAR(curve.arms.force[l], truth.force, 1e-6 * scale) << chosen[l];
    EXPECT_NEAR(curve.arms.stiffness[l], truth.stiffness, 1e-3 * scale) << chosen[l];
    EXPECT_NEAR(curve.moved.kinetic[l], inertia.kinetic_mass, 2e-5) << chosen[l];
    EXPECT_NEAR(curve.moved.coupled[l], inertia.coupled_mass, 1e-6) << chosen[l];
    EXPECT_NEAR(curve.moved.friction[l], inertia.friction, 1e-5) << chosen[l];
    EXPECT_NEAR(energy[l], truth.energy - 2.0 * chosen[l] + 3.0 * inertia.mass_moment, 1e-8 * scale) << chosen[l];
  }
}

TEST(Lanes, RowsComeByColumns) {
  std::vector<rom::EightReals> table(5);
  for (int row = 0; row < 5; ++row) {
    for (int k = 0; k < 8; ++k) table[row].at[k] = 10 * row + k;
  }
  rom::LaneReals wanted{};
  for (int l = 0; l < rom::LANES; ++l) wanted.lane[l] = (3 * l + 1) % 5;
  Real column[8];
  rom::tested::columns(table.data(), rom::tested::whole(Real(wanted), 4), column);
  for (int k = 0; k < 8; ++k) {
    for (int l = 0; l < rom::LANES; ++l) EXPECT_EQ(column[k][l], 10 * wanted.lane[l] + k) << k << " " << l;
  }
}

TEST(Lanes, DecayIsTheExponential) {
  rom::LaneReals at{};
  for (int l = 0; l < rom::LANES; ++l) at.lane[l] = 0.125 * l;
  const Real told = rom::tested::decayed(Real(at));
  for (int l = 0; l < rom::LANES; ++l) EXPECT_NEAR(told[l] / std::exp(-at.lane[l]), 1, 1e-14) << at.lane[l];
}

}  // namespace
