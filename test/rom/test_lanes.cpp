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

double laneOf(const Real& value, int l) { return value.part[l / rom::tested::NATIVE][l % rom::tested::NATIVE]; }

TEST(Lanes, CurvesAreThoseOfThePotentialBeyondTheTableToo) {
  const auto vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  const auto table = vehicle::armTableOf(vehicle);
  const rom::VehicleCurves curves(table, vehicle::wingTableOf(vehicle, table));
  const rom::EnergySpline& spline = curves.spline();
  const rom::UniformCurves grid(spline, spline.lowest(), spline.highest(), curves.arms(), curves.wing());
  const rom::CurvesView view = grid.view();
  rom::EightReals travels{};
  const double chosen[] = {-0.06, -0.03, -0.0151, -0.004, 0.0113, 0.0467, 0.0799, 0.1};
  for (int l = 0; l < rom::LANES; ++l) travels.lane[l] = chosen[l];
  const Real u(travels);
  const auto place = rom::tested::locate(view, u);
  const auto force = rom::tested::arms(view, u, place);
  const Real energy = rom::tested::armsEnergy(view, u, place), moment = rom::tested::moment(view.arms, u, place);
  rom::tested::Moved moved{0.0, 0.0, 0.0, 0.0, 0.0};
  rom::tested::addMoved(view.arms, u, place, Real(1.0), &moved);
  for (int l = 0; l < rom::LANES; ++l) {
    const rom::PotentialSample truth = spline.at(chosen[l]);
    const rom::InertiaSample inertia = curves.arms()->at(chosen[l]);
    const double scale = std::abs(truth.force) + 1;
    EXPECT_NEAR(laneOf(force.force, l), truth.force, 1e-6 * scale) << chosen[l];
    EXPECT_NEAR(laneOf(force.stiffness, l), truth.stiffness, 1e-3 * scale) << chosen[l];
    EXPECT_NEAR(laneOf(energy, l), truth.energy, 1e-8 * scale) << chosen[l];
    EXPECT_NEAR(laneOf(moved.kinetic, l), inertia.kinetic_mass, 1e-6) << chosen[l];
    EXPECT_NEAR(laneOf(moved.coupled, l), inertia.coupled_mass, 1e-6) << chosen[l];
    EXPECT_NEAR(laneOf(moment, l), inertia.mass_moment, 1e-8) << chosen[l];
  }
}

}  // namespace
