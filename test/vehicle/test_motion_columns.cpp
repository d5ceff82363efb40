// What trials taught, as optional columns of a force table: tables without them are read as ever, bad ones are refused.
#include <gtest/gtest.h>
#include <hdf5.h>

#include <cmath>
#include <limits>

#include "snapwing/common/error.h"
#include "snapwing/common/hdf5_file.h"
#include "snapwing/common/output_file.h"
#include "snapwing/vehicle/force_table.h"
#include "snapwing/vehicle/motion_columns.h"
#include "support/own_folder.h"
#include "support/paths.h"

namespace snapwing::vehicle {
namespace {

using common::hdf5::Handle;

constexpr std::size_t POINTS = 20;

ForceTable plainTable() {
  ForceTable t;
  for (std::size_t i = 0; i < POINTS; ++i) {
    const double u = 1e-3 * static_cast<double>(i);
    t.travel.push_back(u);
    t.force.push_back(2 * u), t.stiffness.push_back(2), t.energy.push_back(u * u);
    t.rotation.push_back(u), t.min_det_f.push_back(1);
    t.kinetic_mass.push_back(5e-3), t.coupled_mass.push_back(-6e-3);
    t.stable.push_back(1), t.iterations.push_back(1);
  }
  t.mass = 0.011;
  t.provenance["rung"] = "closed form";
  return t;
}

void write(hid_t group, const char* name, const char* unit, const std::vector<double>& values) {
  const hsize_t size = values.size();
  const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose, name, "make a space");
  const Handle set(H5Dcreate2(group, name, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose,
                   name, "make a dataset");
  H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  common::hdf5::writeAttribute(set, "unit", unit, name);
}

/// Columns of a file; those that are changed by `change`.
struct Columns {
  std::vector<double> effective = std::vector<double>(POINTS, 0.21), fixed = std::vector<double>(POINTS, 0.2),
                      damping = std::vector<double>(POINTS, 3.5), covered{0.002, 0.015};
  const char* mass_unit = "kg";
};

std::string tableWith(const Columns& columns) {
  const std::string path = test::ownFolder() + "motion_columns.h5";
  saveForceTable(plainTable(), path);
  const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose, path, "open");
  const Handle group(H5Gcreate2(file, "motion", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, path, "make a group");
  write(group, "effective_mass", columns.mass_unit, columns.effective);
  write(group, "static_mass", "kg", columns.fixed);
  write(group, "damping", "N s/m", columns.damping);
  write(group, "covered", "m", columns.covered);
  return path;
}

TEST(MotionColumns, AreReadAndTheTableIsTheSame) {
  Columns columns;
  columns.effective[3] = 0.25, columns.damping[4] = 0;
  const std::string path = tableWith(columns);
  const auto motion = loadMotionColumns(path);
  ASSERT_TRUE(motion.has_value());
  EXPECT_EQ(motion->effective_mass, columns.effective);
  EXPECT_EQ(motion->static_mass, columns.fixed);
  EXPECT_EQ(motion->damping, columns.damping);
  EXPECT_EQ(motion->covered_from, 0.002);
  EXPECT_EQ(motion->covered_to, 0.015);
  EXPECT_EQ(loadForceTable(path).kinetic_mass, plainTable().kinetic_mass);
}

TEST(MotionColumns, ATableWithoutThemHasNone) {
  const std::string path = test::ownFolder() + "no_motion_columns.h5";
  saveForceTable(plainTable(), path);
  EXPECT_FALSE(loadMotionColumns(path).has_value());
  EXPECT_NO_THROW(loadForceTable(path));
  EXPECT_FALSE(loadMotionColumns(test::sourceDir() + "/data/tables/arris_x220_planar.h5").has_value()) << "shipped";
}

/// What both readers say of a bad file; they say the same.
std::string refusal(const Columns& columns) {
  const std::string path = tableWith(columns);
  std::string of_table, of_columns;
  try {
    loadForceTable(path);
  } catch (const common::FileError& e) {
    of_table = e.what();
  }
  try {
    loadMotionColumns(path);
  } catch (const common::FileError& e) {
    of_columns = e.what();
  }
  EXPECT_EQ(of_table, of_columns);
  EXPECT_NE(of_table.find(path), std::string::npos) << of_table;
  return of_table;
}

TEST(MotionColumns, BadOnesAreRefusedByName) {
  const auto with = [](const auto& change) {
    Columns columns;
    change(columns);
    return refusal(columns);
  };
  const auto has = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text << " lacks " << part;
  };
  has(with([](Columns& c) { c.effective[7] = std::nan(""); }), "'motion/effective_mass' is nan kg at entry 7");
  has(with([](Columns& c) { c.effective[7] = 0; }), "allowed: above 0");
  has(with([](Columns& c) { c.fixed[2] = -0.1; }), "'motion/static_mass' is -0.1 kg at entry 2");
  has(with([](Columns& c) { c.damping[0] = -1; }), "'motion/damping' is -1 N s/m at entry 0; allowed: 0 or more");
  has(with([](Columns& c) { c.damping[0] = std::numeric_limits<double>::infinity(); }), "'motion/damping' is inf");
  has(with([](Columns& c) { c.damping.pop_back(); }), "'motion/damping' has 19 entries, travel has 20");
  has(with([](Columns& c) { c.covered = {0.01, 0.01}; }), "'motion/covered' is 0.01 .. 0.01 m");
  has(with([](Columns& c) { c.covered = {0.01}; }), "motion/covered does not have two travels");
  has(with([](Columns& c) { c.mass_unit = "g"; }), "'effective_mass' is in 'g'; allowed: 'kg'");
}

}  // namespace
}  // namespace snapwing::vehicle
