#pragma once
/// Wings with the inertia of a smooth hump, as large as the shipped ones': for tests of the dynamics alone; and the
/// wings that were designed for the arm of exampleTable().

#include "snapwing/vehicle/table_origin.h"
#include "snapwing/vehicle/wing_table.h"
#include "support/example_table.h"
#include "support/paths.h"

namespace snapwing::testing {

/// A hump between 1 and 23 mm, with two continuous derivatives.
inline double exampleHump(double u) {
  const double x = (u - 0.012) / 0.011, inside = 1 - x * x;
  return inside > 0 ? inside * inside * inside : 0.0;
}

/// K and S at u [m]; S^2 stays below the wings' mass times K, as it must.
inline double exampleWingKinetic(double u) { return 0.03 + 0.6 * exampleHump(u); }
inline double exampleWingCoupled(double u) { return 0.10 * exampleHump(u); }

/// @param mass  times the inertia above; @param friction  at the pins [N]
inline vehicle::WingTable exampleWing(double mass = 1.0, double friction = 0.0, int points = 321) {
  vehicle::WingTable t;
  for (int i = 0; i < points; ++i) {
    const double u = 0.08 * i / (points - 1);
    t.travel.push_back(u);
    t.kinetic_mass.push_back(mass * exampleWingKinetic(u));
    t.coupled_mass.push_back(mass * exampleWingCoupled(u));
    t.friction_force.push_back(friction);
    for (auto* column :
         {&t.arm_rotation, &t.wing_angle, &t.rocker_angle, &t.joint1_x, &t.joint1_y, &t.joint2_x, &t.joint2_y, &t.tip_x,
          &t.tip_y, &t.transmission_ratio, &t.angle_per_travel, &t.transmission_angle}) {
      column->push_back(u);
    }
  }
  return t;
}

/// Wings of the study's arm: `snapwing design wing` on the force table of data/arms/arris_x220_study.csv. Arm and wing
/// of one design: held to each other as a vehicle's own are.
inline vehicle::WingTable exampleTableWing(const vehicle::Vehicle& vehicle) {
  vehicle::WingTable wing = vehicle::loadWingTable(test::sourceDir() + "/test/data/wings/arris_x220_study_wing.h5");
  vehicle::requireOrigin(wing, exampleTable(), vehicle);
  return wing;
}

}  // namespace snapwing::testing
