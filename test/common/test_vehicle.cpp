#include <gtest/gtest.h>

#include <filesystem>
#include <optional>

#include "snapwing/common/error.h"
#include "snapwing/common/force_table.h"
#include "snapwing/common/provenance.h"
#include "snapwing/common/vehicle.h"
#include "snapwing/common/wing_table.h"
#include "support/paths.h"

namespace snapwing::common {
namespace {

namespace fs = std::filesystem;

/// The shipped vehicle with one piece of text replaced, written to a file of its own.
std::string edited(const std::string& from, const std::string& to) {
  std::string text = readFile(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  const auto at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("the shipped vehicle no longer holds: " + from);
  text.replace(at, from.size(), to);
  const std::string path = testing::TempDir() + "edited_vehicle_" + sha256(text).substr(0, 12) + ".yaml";
  writeFileAtomically(path, text);
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
    // Tables go stale silently: each names what it was computed from (scripts/make_tables).
    EXPECT_EQ(loadForceTable(v.arm.table_file).provenance.at("density_sha256"), sha256OfFile(v.arm.density_file));
    if (const std::optional<WingTable> wing = wingTableOf(v)) {
      EXPECT_NE(wing->provenance.at("arm_motion").find(sha256OfFile(v.arm.table_file)), std::string::npos);
    }
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

struct Wrong {
  const char* from;
  const char* to;
  const char* key;
};

class WrongVehicle : public testing::TestWithParam<Wrong> {};

TEST_P(WrongVehicle, IsRefusedWithTheKey) {
  const std::string path = edited(GetParam().from, GetParam().to);
  try {
    loadVehicle(path);
    FAIL() << "was accepted";
  } catch (const SettingError& e) {
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
                    Wrong{"source: \"paper: ring of 125 mm\"", "source: \"\"", "geometry.ring_radius.source"}),
    [](const auto& mistake) { return "Mistake" + std::to_string(mistake.index); });

}  // namespace
}  // namespace snapwing::common
