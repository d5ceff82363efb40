// Where a loaded basin ends: the largest force between the equilibria, with the weight of arms and wings.
#include <gtest/gtest.h>

#include <cmath>

#include "snapwing/rom/loaded_basins.h"
#include "snapwing/rom/vehicle_curves.h"
#include "snapwing/vehicle/table_origin.h"
#include "support/paths.h"

namespace {

using namespace snapwing;

TEST(LoadedBasins, EndWhereTheForceIsLevel) {
  // The excess over a vanished barrier is measured from there: a tenth of a millimetre is .006 of a margin.
  const auto vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  const auto table = vehicle::armTableOf(vehicle);
  const rom::VehicleCurves curves(table, vehicle::wingTableOf(vehicle, table));
  const rom::EnergySpline& spline = curves.spline();
  const rom::TravelInertia moved = *curves.arms() + *curves.wing();
  const rom::LoadedBasins basins(spline, &moved);
  for (const double specific : {-3.0, -0.5, 0.5, 4.0, 15.0}) {
    const auto force = [&](double u) { return spline.at(u).force + specific * moved.at(u).coupled_mass; };
    const rom::Equilibria& e = spline.equilibria();
    double peak = e.first;
    for (double u = e.first; u < e.barrier; u += 1e-6) {
      if (force(u) > force(peak)) peak = u;
    }
    const rom::LoadedBarrier gone = basins.barrierUnder({1.5 * force(peak), specific});
    EXPECT_FALSE(gone.exists);
    EXPECT_NEAR(gone.peak, peak, 2e-6) << specific;
    EXPECT_NEAR(basins.limit(vehicle::Mode::FIXED_WING, specific), force(peak), 1e-7) << specific;  // of the scan
    EXPECT_NEAR(gone.excess, 0.5 * force(peak) * (e.barrier - peak), 1e-6) << specific;
  }
}

}  // namespace
