#include <gtest/gtest.h>

#include <cmath>

#include "snapwing/common/error.h"
#include "snapwing/vehicle/vehicle_parameters.h"
#include "support/example_table.h"
#include "support/paths.h"

namespace snapwing::vehicle {
namespace {

Vehicle vehicle() { return loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml"); }

TEST(VehicleParameters, NominalIsTheValueOfEachQuantity) {
  const Vehicle v = vehicle();
  const VehicleParameters p = realise(v, testing::exampleTable());
  EXPECT_DOUBLE_EQ(p.ring_mass + p.centre_mass, v.masses.total.value);
  EXPECT_DOUBLE_EQ(p.centre_mass, v.masses.centre.value);
  EXPECT_DOUBLE_EQ(p.max_thrust, v.rotors.count * v.rotors.max_thrust.value);
  EXPECT_DOUBLE_EQ(p.boom_mass, v.boom.inertia.value / (v.boom.length.value * v.boom.length.value));
  EXPECT_DOUBLE_EQ(p.ring_drag, 0.5 * v.drag.air_density.value * v.drag.ring_cda.value);
}

TEST(VehicleParameters, DampingFollowsFromTheStiffnessAtTheSecondEquilibrium) {
  const Vehicle v = vehicle();
  const VehicleParameters p = realise(v, testing::exampleTable());
  // The study's curve rises from -.091273 N at 52 mm to .044659 at 53: 4 arms, slope by hand.
  const double stiffness = 4.0 * (0.044659 + 0.091273) / 1e-3;
  const double mass = p.ring_mass * p.centre_mass / (p.ring_mass + p.centre_mass);
  EXPECT_NEAR(p.damping, 2.0 * v.damping_ratio.value * std::sqrt(stiffness * mass), 0.02 * p.damping);
}

TEST(VehicleParameters, EndsOfTheBoxAreValuePlusMinus) {
  const Vehicle v = vehicle();
  const auto& names = uncertainNames();
  const VehicleParameters nominal = realise(v, testing::exampleTable());
  std::vector<double> xi(names.size(), 0.0);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] != "drag.ring_cda") continue;
    xi[i] = 1.0;
    const VehicleParameters high = realise(v, testing::exampleTable(), xi);
    EXPECT_NEAR(high.ring_drag / nominal.ring_drag, v.drag.ring_cda.high() / v.drag.ring_cda.value, 1e-12);
    EXPECT_DOUBLE_EQ(high.centre_drag, nominal.centre_drag);
  }
}

TEST(VehicleParameters, RefusesBadCoordinatesAndCurvesWithoutASecondMode) {
  const Vehicle v = vehicle();
  ForceTable table = testing::exampleTable();
  EXPECT_THROW(realise(v, table, {0.0}), common::Error);
  std::vector<double> xi(uncertainNames().size(), 0.0);
  xi[2] = 1.5;
  EXPECT_THROW(realise(v, table, xi), common::Error);
  xi[2] = NAN;
  EXPECT_THROW(realise(v, table, xi), common::Error);
  ForceTable heavy = testing::exampleTableWithMass();
  heavy.mass = 0.1;  // four of them: more than ring and arms weigh
  EXPECT_THROW(realise(v, heavy), common::Error);
  for (std::size_t i = 0; i < table.travel.size(); ++i) {
    table.force[i] = 100.0 * table.travel[i];
    table.stiffness[i] = 100.0;
  }
  EXPECT_THROW(realise(v, table), common::Error);
}

}  // namespace
}  // namespace snapwing::vehicle
