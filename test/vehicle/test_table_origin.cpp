// A table is used for the arm that it was computed for, and only if its columns can belong to one arm.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>

#include "snapwing/common/error.h"
#include "snapwing/common/output_file.h"
#include "snapwing/common/provenance.h"
#include "snapwing/vehicle/force_curve_file.h"
#include "snapwing/vehicle/table_origin.h"
#include "support/paths.h"
#include "table_consistency.h"

namespace snapwing::vehicle {
namespace {

Vehicle shipped() { return loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml"); }

std::string messageOf(const std::function<void()>& act) {
  try {
    act();
  } catch (const common::Error& error) {
    return error.what();
  }
  return "";
}

/// Whether `text` holds every one of the words.
testing::AssertionResult holds(const std::string& text, const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    if (text.find(word) == std::string::npos) return testing::AssertionFailure() << "no '" << word << "' in: " << text;
  }
  return testing::AssertionSuccess();
}

struct Change {
  const char* named;  ///< what the message must name
  std::function<void(Vehicle&)> make;
};

TEST(TableOrigin, TableOfAnotherArmIsRefusedByName) {
  const Change changes[] = {
      {"material.youngs_modulus 5500000", [](Vehicle& v) { v.material.youngs_modulus.value = 55e6; }},
      {"material.poisson_ratio", [](Vehicle& v) { v.material.poisson_ratio.value = 0.4; }},
      {"arm.count 4", [](Vehicle& v) { v.arm.count = 8; }},
      {"arm.density_file", [](Vehicle& v) { v.arm.density_file = test::sourceDir() + "/data/arms/arm_paper.csv"; }},
      {"thicknesses", [](Vehicle& v) { v.arm.bar_thickness = 0.011; }},
      {"pin", [](Vehicle& v) { v.arm.pin_x = 0.077; }},
      {"clamp", [](Vehicle& v) { v.arm.clamp_y_low = 0.022; }}};
  for (const Change& change : changes) {
    Vehicle vehicle = shipped();
    change.make(vehicle);
    EXPECT_TRUE(holds(messageOf([&] { armTableOf(vehicle); }),
                      {change.named, "another arm", "snapwing curve " + vehicle.file}));
  }
}

TEST(TableOrigin, WhatTheCurveDoesNotDependOnMayChange) {
  Vehicle vehicle = shipped();
  vehicle.sha256 = "of an edited file";
  vehicle.battery.capacity.value *= 2;
  vehicle.masses.total.value += 0.1;
  vehicle.rotors.count = 6;
  vehicle.arm.force_scale.value = 0.9;
  vehicle.limits.travel_max = 0.070;
  EXPECT_NO_THROW(armTableOf(vehicle));
}

TEST(TableOrigin, ACurveIsTheTableWithoutTheOutlines) {
  const Vehicle vehicle = shipped();
  const ForceTable table = armTableOf(vehicle), curve = armCurveOf(vehicle);
  EXPECT_FALSE(table.shapes.moved.empty());
  EXPECT_TRUE(curve.shapes.rest.empty());
  EXPECT_TRUE(curve.shapes.moved.empty());
  EXPECT_EQ(curve.travel, table.travel);
  EXPECT_EQ(curve.force, table.force);
  EXPECT_EQ(curve.force_back, table.force_back);
  EXPECT_EQ(curve.kinetic_mass, table.kinetic_mass);
  EXPECT_EQ(curve.provenance, table.provenance);
  Vehicle other = vehicle;
  other.material.poisson_ratio.value = 0.4;
  EXPECT_EQ(messageOf([&] { armCurveOf(other); }), messageOf([&] { armTableOf(other); }));
  EXPECT_NE(messageOf([&] { armCurveOf(other); }), "");
}

TEST(TableOrigin, TableWithoutOriginIsRefusedUnlessMeasured) {
  const Vehicle vehicle = shipped();
  ForceTable table = loadForceTable(vehicle.arm.table_file);
  table.provenance = {{"note", "by hand"}};
  EXPECT_TRUE(holds(messageOf([&] { requireOrigin(table, vehicle, "t.h5"); }), {"t.h5", "does not say", "measured"}));
  table.provenance["origin"] = "measured";
  EXPECT_NO_THROW(requireOrigin(table, vehicle, "t.h5"));
  table.arm_count = 3;
  EXPECT_TRUE(holds(messageOf([&] { requireOrigin(table, vehicle, "t.h5"); }), {"arm.count"}));
}

TEST(TableOrigin, FileThatIsNotThereIsNamedWithKeyPathAndRemedy) {
  Vehicle vehicle = shipped();
  vehicle.arm.table_file = "/nowhere/table.h5";
  EXPECT_TRUE(holds(messageOf([&] { armTableOf(vehicle); }),
                    {"arm.table_file", "/nowhere/table.h5", "snapwing curve", "snapwing vehicle new"}));
  vehicle = shipped();
  vehicle.arm.density_file = "/nowhere/density.csv";
  EXPECT_TRUE(holds(messageOf([&] { armTableOf(vehicle); }), {"arm.density_file", "/nowhere/density.csv"}));
  vehicle = shipped();
  vehicle.wing.table_file = "/nowhere/wing.h5";
  const ForceTable arm = armTableOf(vehicle);
  EXPECT_TRUE(holds(messageOf([&] { wingTableOf(vehicle, arm); }), {"wing.table_file", "leaves out the key wing"}));
}

TEST(TableOrigin, WingOfAnotherArmIsRefused) {
  Vehicle vehicle = shipped();
  const ForceTable arm = armTableOf(vehicle);
  const WingTable wing = loadWingTable(vehicle.wing.table_file);
  EXPECT_NO_THROW(requireOrigin(wing, arm, vehicle));
  ForceTable other = arm;
  for (double& rotation : other.rotation) rotation *= 1.01;
  EXPECT_TRUE(holds(messageOf([&] { requireOrigin(wing, other, vehicle); }), {"rotation", "snapwing design wing"}));
  vehicle.geometry.axle_below_ring += 0.001;
  EXPECT_TRUE(holds(messageOf([&] { requireOrigin(wing, arm, vehicle); }), {"axle's height"}));
}

class Consistency : public testing::Test {
 protected:
  Vehicle vehicle_ = shipped();
  ForceTable table_ = loadForceTable(vehicle_.arm.table_file);
  std::string complaint() const {
    return messageOf([this] {
      requireConsistent(table_, "t.h5");
      requireTravelOf(table_, vehicle_, "t.h5");
      requireMassOf(table_, vehicle_, "t.h5");
    });
  }
  static void scale(std::vector<double>& column, double factor) {
    for (double& value : column) value *= factor;
  }
};

TEST_F(Consistency, ShippedTableIsConsistentAlsoWithFewPoints) {
  EXPECT_EQ(complaint(), "");
  ForceTable coarse = table_;
  for (auto* column : {&coarse.travel, &coarse.force, &coarse.stiffness, &coarse.energy}) {
    std::vector<double> kept;
    for (std::size_t k = 0; k < column->size(); k += 5) kept.push_back((*column)[k]);
    *column = kept;
  }
  EXPECT_NO_THROW(requireConsistent(coarse, "t.h5"));
}

TEST_F(Consistency, TravelInMillimetresIsRefusedWithTheFactor) {
  scale(table_.travel, 1e3);
  EXPECT_TRUE(holds(complaint(), {"energy", "factor", "mm for m"}));
  scale(table_.energy, 1e3), scale(table_.stiffness, 1e-3);  // consistent, but no arm of .12 m moves by 80 m
  EXPECT_TRUE(holds(complaint(), {"travel", "80 m", "mm"}));
}

TEST_F(Consistency, ForceThatIsNotTheSlopeOfTheEnergyIsRefused) {
  scale(table_.force, 1.1), scale(table_.stiffness, 1.1);
  EXPECT_TRUE(holds(complaint(), {"'force' is not the slope of 'energy'"}));
}

TEST_F(Consistency, StiffnessThatIsNotTheSlopeOfTheForceIsRefused) {
  scale(table_.stiffness, 1e-3);  // N/mm
  EXPECT_TRUE(holds(complaint(), {"'stiffness' is not the slope of 'force'", "another unit"}));
}

TEST_F(Consistency, ForceAtRestIsRefused) {
  const double more = 0.05 * *std::max_element(table_.force.begin(), table_.force.end());
  for (std::size_t k = 0; k < table_.force.size(); ++k) {
    table_.force[k] += more;
    table_.energy[k] += more * table_.travel[k];
  }
  EXPECT_TRUE(holds(complaint(), {"'force' at u = 0"}));
}

TEST_F(Consistency, MassesInGramsAreRefused) {
  ASSERT_GT(table_.mass, 0);
  scale(table_.kinetic_mass, 1e3);
  EXPECT_TRUE(holds(complaint(), {"'kinetic_mass'", "10 times 'mass'", "is it in g?"}));
  table_.mass *= 1e3;
  EXPECT_TRUE(holds(complaint(), {"'mass'", "4 arms", "masses.total - masses.centre", "is it in g?"}));
}

TEST_F(Consistency, TableShorterThanTheLimitsIsRefused) {
  vehicle_.limits.travel_max = 0.081;
  EXPECT_TRUE(holds(complaint(), {"limits.travel_min .. travel_max", "0.081", "snapwing curve"}));
}

}  // namespace
}  // namespace snapwing::vehicle
