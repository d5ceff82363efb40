#include <gtest/gtest.h>

#include <filesystem>
#include <optional>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"
#include "snapwing/vehicle/force_table.h"
#include "snapwing/vehicle/table_origin.h"
#include "snapwing/vehicle/vehicle.h"
#include "snapwing/vehicle/wing_table.h"
#include "support/paths.h"

namespace snapwing::vehicle {
namespace {

namespace fs = std::filesystem;

/// The shipped vehicle with one piece of text replaced, written to a file of its own.
std::string edited(const std::string& from, const std::string& to) {
  std::string text = common::readFile(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  const auto at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("the shipped vehicle no longer holds: " + from);
  text.replace(at, from.size(), to);
  const std::string path = testing::TempDir() + "edited_vehicle_" + common::sha256(text).substr(0, 12) + ".yaml";
  common::writeFileAtomically(path, text);
  return path;
}

TEST(Vehicle, EveryShippedFileLoads) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(test::sourceDir() + "/config/vehicles")) {
    SCOPED_TRACE(entry.path());
    const Vehicle v = loadVehicle(entry.path().string());
    EXPECT_GT(v.masses.total.low(), v.masses.centre.high());
    EXPECT_EQ(v.sha256.size(), 64u);
    EXPECT_TRUE(fs::exists(v.arm.density_file)) << v.arm.density_file;
    EXPECT_TRUE(fs::exists(v.arm.table_file)) << v.arm.table_file;
    // Each table belongs to the arm of its vehicle (scripts/make_tables).
    const ForceTable arm = armTableOf(v);
    EXPECT_EQ(wingTableOf(v, arm).has_value(), v.hasWing());
    ++count;
  }
  EXPECT_GE(count, 1);
}

TEST(Vehicle, PaperNumbersAreInSi) {
  const Vehicle v = loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  EXPECT_DOUBLE_EQ(v.masses.total.value, 0.783);
  EXPECT_DOUBLE_EQ(v.geometry.ring_radius, 0.125);
  EXPECT_DOUBLE_EQ(v.material.youngs_modulus.value, 5.5e6);
  EXPECT_DOUBLE_EQ(v.rotors.count * v.rotors.max_thrust.value, 35.6);
}

/// The shipped vehicle without some of its top-level keys, each in one block up to an empty line.
std::string without(const std::vector<std::string>& keys) {
  std::string text = common::readFile(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  for (const std::string& key : keys) {
    const auto at = text.find("\n" + key + ":");
    text.erase(at, text.find("\n\n", at + 1) - at);
  }
  const std::string path = testing::TempDir() + "vehicle_without_" + common::sha256(text).substr(0, 12) + ".yaml";
  common::writeFileAtomically(path, text);
  return path;
}

TEST(Vehicle, BoomBatteryAndWingMayBeLeftOut) {
  const std::string path = without({"boom", "battery", "wing"});
  const Vehicle v = loadVehicle(path);
  EXPECT_FALSE(v.boom.given);
  EXPECT_FALSE(v.hasWing());
  EXPECT_EQ(v.battery.cells, 0);
  try {
    v.requireBoom("the trial");
    FAIL() << "a boom that is not there was taken";
  } catch (const common::SettingError& e) {
    EXPECT_EQ(e.key(), "boom") << e.what();
    EXPECT_NE(std::string(e.what()).find("--mount free"), std::string::npos) << e.what();
  }
  EXPECT_NO_THROW(loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml").requireBoom("the trial"));
  fs::remove(path);
}

struct Wrong {
  const char* from;
  const char* to;
  const char* key;
};

/// Text of the shipped vehicle with a memory of its material, in place of its density's line.
#define DENSITY "  mass_density: {value: 1210.0, unit: kg/m3, source: \"assumption: usual TPU filament\"}"
#define MEMORY(modulus, share, time)                                       \
  DENSITY "\n  relaxation: {modulus: " modulus                             \
          ", terms: [{share: {value: 0.1, unit: \"1\", source: a}, time: " \
          "{value: 0.05, unit: s, source: a}}, {share: {value: " share     \
          ", unit: \"1\", source: a}, time: {value: " time ", unit: s, source: a}}]}"

TEST(Vehicle, ReadsTheMemoryOfItsMaterial) {
  const std::string path = edited(DENSITY, MEMORY("fast", "0.2", "300"));
  const Relaxation relaxation = loadVehicle(path).material.relaxation;
  EXPECT_TRUE(relaxation.modulus_is_fast);
  ASSERT_EQ(relaxation.terms.size(), 2U);
  EXPECT_EQ(relaxation.terms[1].share.value, 0.2);
  EXPECT_EQ(relaxation.terms[1].time.value, 300);
  fs::remove(path);
}

TEST(Vehicle, StopOfTheWingsAndStrainLimitMayBeStated) {
  const Vehicle shipped = loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  EXPECT_EQ(shipped.wing.stop.value, 10);
  EXPECT_FALSE(shipped.material.strain_limit.has_value());
  const std::string path = edited(DENSITY, DENSITY "\n  strain_limit: {value: 4, unit: \"1\", source: a}");
  EXPECT_EQ(loadVehicle(path).material.strain_limit->value, 4);
  fs::remove(path);
  EXPECT_EQ(loadVehicle(without({"wing"})).wing.stop.value, 0);
}

class WrongVehicle : public testing::TestWithParam<Wrong> {};

TEST_P(WrongVehicle, IsRefusedWithTheKey) {
  const std::string path = edited(GetParam().from, GetParam().to);
  try {
    loadVehicle(path);
    FAIL() << "was accepted";
  } catch (const common::SettingError& e) {
    EXPECT_EQ(e.key(), GetParam().key) << e.what();
  }
  fs::remove(path);
}

INSTANTIATE_TEST_SUITE_P(
    Mistakes, WrongVehicle,
    testing::Values(Wrong{"ring_radius:", "ring_radios:", "geometry.ring_radius"},
                    Wrong{"name: arris_x220", "name: arris_x220\ncolour: red", "colour"},
                    Wrong{"value: 0.125, unit: m", "value: 125, unit: mm", "geometry.ring_radius.unit"},
                    Wrong{"value: 0.005, unit: m,", "value: -0.005, unit: m,", "arm.leg_thickness.value"},
                    Wrong{"value: 0.40, unit: kg", "value: 0.80, unit: kg", "masses.centre"},
                    Wrong{"value: 0.48", "value: 0.5", "material.poisson_ratio.value"},
                    Wrong{"count: 4", "count: four", "arm.count"},
                    Wrong{"inertia_scale: {value: 1.0", "inertia_scale: {value: -1.0", "wing.inertia_scale.value"},
                    Wrong{"friction_scale: {value: 1.0", "frictoin_scale: {value: 1.0", "wing.friction_scale"},
                    Wrong{"source: \"paper: ring of 125 mm\"", "source: \"\"", "geometry.ring_radius.source"},
                    Wrong{"ring_radius: {value: 0.125", "ring_radius: {value: 0.145", "arm.pin_x"},  // ends inside
                    Wrong{"housing_radius: {value: 0.045", "housing_radius: {value: 0.065", "arm.pin_x"},
                    Wrong{"pin_y: {value: 0.002", "pin_y: {value: 0.030", "arm.pin_y"},  // outside the L
                    Wrong{"clamp_y_high: {value: 0.040", "clamp_y_high: {value: 0.020", "arm.clamp_y_high"},
                    Wrong{"clamp_y_high: {value: 0.040", "clamp_y_high: {value: 0.045", "arm.clamp_y_high.value"},
                    Wrong{"bar_height: {value: 0.020", "bar_height: {value: 0.0", "arm.bar_height.value"},
                    Wrong{"count: 4", "count: 0", "arm.count"},
                    Wrong{"leg_thickness: {value: 0.005", "leg_thickness: {value: 0.100", "arm.count"},
                    Wrong{"travel_max: {value: 0.080", "travel_max: {value: 0.0", "limits.travel_max.value"},
                    Wrong{"travel_max: {value: 0.080", "travel_max: {value: 0.8", "limits.travel_max"},
                    Wrong{"throttle_high: {value: 2000.0", "throttle_high: {value: 1000.0", "radio.throttle_high"},
                    Wrong{"motor_full: {value: 2000.0", "motor_full: {value: 1070.0", "radio.motor_full"},
                    Wrong{DENSITY, MEMORY("fast", "-0.2", "1"), "material.relaxation.terms[1].share.value"},
                    Wrong{DENSITY, MEMORY("fast", ".nan", "1"), "material.relaxation.terms[1].share.value"},
                    Wrong{DENSITY, MEMORY("fast", "0.95", "1"), "material.relaxation.terms[1].share"},
                    Wrong{DENSITY, MEMORY("slow", "0.2", "0"), "material.relaxation.terms[1].time.value"},
                    Wrong{DENSITY, MEMORY("slow", "0.2", ".inf"), "material.relaxation.terms[1].time.value"},
                    Wrong{DENSITY, MEMORY("soft", "0.2", "1"), "material.relaxation.modulus"},
                    Wrong{DENSITY, DENSITY "\n  relaxation: {modulus: slow, terms: []}", "material.relaxation.terms"},
                    Wrong{"length: {value: 0.987", "length: {value: 0.100", "boom.length"}),
    [](const auto& mistake) { return "Mistake" + std::to_string(mistake.index); });

}  // namespace
}  // namespace snapwing::vehicle
