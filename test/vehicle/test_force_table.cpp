#include <fcntl.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/file.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"
#include "snapwing/vehicle/force_table.h"
#include "support/paths.h"

namespace snapwing::vehicle {
namespace {

/// Force k u (u - b)(u - c): equilibria at 0, b, c, all in closed form.
constexpr double K = 3e4, B = 0.028, C = 0.053;
double force(double u) { return K * u * (u - B) * (u - C); }
double stiffness(double u) { return K * (3 * u * u - 2 * u * (B + C) + B * C); }
double energy(double u) { return K * (u * u * u * u / 4 - (B + C) * u * u * u / 3 + B * C * u * u / 2); }

ForceTable cubicTable(int arms = 4) {
  ForceTable t;
  for (int i = -10; i <= 80; ++i) {
    const double u = 1e-3 * i;
    t.travel.push_back(u);
    t.force.push_back(force(u));
    t.stiffness.push_back(stiffness(u));
    t.energy.push_back(energy(u));
    t.rotation.push_back(u / 0.06);
    t.min_det_f.push_back(0.9);
    t.kinetic_mass.push_back(5e-3 + 0.1 * u);
    t.coupled_mass.push_back(-6e-3 - 0.01 * u);
    t.stable.push_back(1);
    t.iterations.push_back(4);
  }
  t.mass = 0.011;
  t.arm_count = arms;
  t.provenance["rung"] = "closed form";
  t.shapes.rest = {{{0, 0}, {1, 0}, {1, 1}}, {{0.2, 0.2}, {0.4, 0.2}}};
  for (double u : t.travel) {
    t.shapes.moved.push_back(t.shapes.rest);
    t.shapes.moved.back()[0][1][1] = u;
  }
  return t;
}

TEST(ForceTable, FeaturesOfACubicAreExact) {
  const CurveFeatures f = curveFeatures(cubicTable());
  const double root = std::sqrt((B + C) * (B + C) - 3 * B * C);
  const double peak = (B + C - root) / 3, valley = (B + C + root) / 3;
  EXPECT_NEAR(f.peak_travel, peak, 1e-12);
  EXPECT_NEAR(f.peak_force, 4 * force(peak), 1e-12);
  EXPECT_NEAR(f.valley_travel, valley, 1e-12);
  EXPECT_NEAR(f.valley_force, 4 * force(valley), 1e-12);
  EXPECT_NEAR(f.barrier_travel, B, 1e-12);
  EXPECT_NEAR(f.second_travel, C, 1e-12);
  EXPECT_NEAR(f.barrier_forward, 4 * energy(B), 1e-14);
  EXPECT_NEAR(f.barrier_back, 4 * (energy(B) - energy(C)), 1e-14);
  EXPECT_TRUE(f.bistable);
  EXPECT_TRUE(std::isnan(f.hysteresis));
}

TEST(ForceTable, MonostableCurveIsSaidToBeSo) {
  ForceTable t = cubicTable();
  for (std::size_t i = 0; i < t.travel.size(); ++i) {
    t.force[i] += 60.0 * t.travel[i];
    t.stiffness[i] += 60.0;
    t.energy[i] += 30.0 * t.travel[i] * t.travel[i];
  }
  const CurveFeatures f = curveFeatures(t);
  EXPECT_FALSE(f.bistable);
  EXPECT_TRUE(std::isnan(f.second_travel));
}

TEST(ForceTable, HysteresisIsTheLargestDifference) {
  ForceTable t = cubicTable();
  t.force_back = t.force;
  t.force_back[30] -= 0.1;
  EXPECT_NEAR(curveFeatures(t).hysteresis, 0.4, 1e-12);
}

TEST(ForceTable, FileKeepsEveryBit) {
  const std::string path = testing::TempDir() + "round_trip.h5";
  const ForceTable t = cubicTable();
  saveForceTable(t, path);
  const ForceTable back = loadForceTable(path);
  EXPECT_EQ(back.travel, t.travel);
  EXPECT_EQ(back.force, t.force);
  EXPECT_EQ(back.stiffness, t.stiffness);
  EXPECT_EQ(back.energy, t.energy);
  EXPECT_EQ(back.stable, t.stable);
  EXPECT_EQ(back.kinetic_mass, t.kinetic_mass);
  EXPECT_EQ(back.coupled_mass, t.coupled_mass);
  EXPECT_EQ(back.mass, t.mass);
  EXPECT_EQ(back.arm_count, t.arm_count);
  EXPECT_EQ(back.provenance, t.provenance);
  EXPECT_EQ(back.shapes.rest, t.shapes.rest);
  EXPECT_EQ(back.shapes.moved, t.shapes.moved);
  EXPECT_TRUE(back.force_back.empty());
  std::filesystem::remove(path);
}

TEST(ForceTable, BadTablesAndFilesAreRefused) {
  const std::string path = testing::TempDir() + "bad_table.h5";
  ForceTable t = cubicTable();
  t.force[5] = std::nan("");
  EXPECT_THROW(saveForceTable(t, path), common::Error);
  EXPECT_FALSE(std::filesystem::exists(path));
  t = cubicTable();
  std::swap(t.travel[3], t.travel[4]);
  EXPECT_THROW(t.validate(), common::Error);
  t = cubicTable();
  t.kinetic_mass[7] = 0.5 * t.coupled_mass[7] * t.coupled_mass[7] / t.mass;  // no mass moves like that
  EXPECT_THROW(t.validate(), common::Error);
  t = cubicTable();
  t.coupled_mass.pop_back();
  EXPECT_THROW(t.validate(), common::Error);
  EXPECT_THROW(loadForceTable(path), common::FileError);
  common::writeFileAtomically(path, "no HDF5");
  EXPECT_THROW(loadForceTable(path), common::FileError);
  common::writeFileAtomically(path, "");
  EXPECT_THROW(loadForceTable(path), common::FileError);
  std::filesystem::remove(path);
}

/// Each reason why a file is not read has a message of its own.
TEST(ForceTable, CutOffFilesAreSaidToBeCutOff) {
  const std::string path = testing::TempDir() + "cut_table.h5";
  saveForceTable(cubicTable(), path);
  const auto whole = std::filesystem::file_size(path);
  const auto refusal = [&] {
    try {
      loadForceTable(path);
    } catch (const common::FileError& e) {
      return std::string(e.what());
    }
    return std::string("taken");
  };
  for (const auto& [size, part] : std::vector<std::pair<std::uintmax_t, std::string>>{
           {whole - 1, "is cut off: it is shorter than its own header says"},
           {whole / 2, "is cut off: it is shorter than its own header says"},
           {200, "is cut off"},
           {40, "is not an HDF5 file, or is truncated within its header"},
           {0, "is empty"}}) {
    std::filesystem::resize_file(path, size);
    EXPECT_NE(refusal().find(part), std::string::npos) << size << ": " << refusal();
  }
  common::writeFileAtomically(path, "no HDF5, but text");
  EXPECT_NE(refusal().find("is not an HDF5 file"), std::string::npos) << refusal();
  std::filesystem::remove(path);
}

/// A writer of HDF5 holds its file by flock(2).
TEST(ForceTable, TableThatAnotherProgramWritesIsSaidToBeLocked) {
  const std::string path = testing::TempDir() + "locked_table.h5";
  saveForceTable(cubicTable(), path);
  const int writer = open(path.c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_EQ(flock(writer, LOCK_EX | LOCK_NB), 0);
  try {
    loadForceTable(path);
    ADD_FAILURE() << "taken";
  } catch (const common::FileError& e) {
    EXPECT_NE(std::string(e.what()).find("another program has it open for writing"), std::string::npos) << e.what();
  }
  close(writer);
  EXPECT_EQ(loadForceTable(path).travel, cubicTable().travel);
  std::filesystem::remove(path);
}

TEST(ForceTable, OlderFormatIsRefusedWithTheCommandThatMakesItAnew) {
  try {
    loadForceTable(test::sourceDir() + "/test/data/tables/format_1.h5");
    FAIL() << "taken";
  } catch (const common::FileError& e) {
    EXPECT_NE(std::string(e.what()).find("format_version is 1"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("snapwing curve VEHICLE.yaml -o TABLE.h5"), std::string::npos) << e.what();
  }
}

TEST(ForceTable, FailedSaveLeavesTheOldFile) {
  const std::string folder = testing::TempDir() + "table_folder";
  std::filesystem::create_directory(folder);
  const std::string path = folder + "/t.h5";
  saveForceTable(cubicTable(), path);
  const std::string before = common::sha256OfFile(path);
  ForceTable broken = cubicTable();
  broken.energy.pop_back();
  EXPECT_THROW(saveForceTable(broken, path), common::Error);
  EXPECT_EQ(common::sha256OfFile(path), before);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
  std::filesystem::remove_all(folder);
}

/// An attribute as h5py writes text: of variable length, in UTF-8.
void addVariableText(hid_t object, const char* name, const char* text) {
  const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  if (H5Aexists(object, name) > 0) H5Adelete(object, name);
  const hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  ASSERT_GE(H5Awrite(attribute, type, &text), 0);
  H5Aclose(attribute);
  H5Sclose(space);
  H5Tclose(type);
}

/// @param values  written as they are, of `count` elements
void addNumbers(hid_t object, const char* name, const std::vector<double>& values, bool scalar) {
  const hsize_t count = values.size();
  const hid_t space = scalar ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &count, nullptr);
  const hid_t attribute = H5Acreate2(object, name, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT);
  ASSERT_GE(H5Awrite(attribute, H5T_NATIVE_DOUBLE, values.data()), 0);
  H5Aclose(attribute);
  H5Sclose(space);
}

TEST(ForceTable, AttributesWrittenByOtherProgramsAreRead) {
  const std::string path = ::testing::TempDir() + "snapwing_by_h5py.h5";
  saveForceTable(cubicTable(), path);
  hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  hid_t group = H5Gopen2(file, "provenance", H5P_DEFAULT);
  addVariableText(group, "note", "checked against the bench, \xc3\xa4");
  addVariableText(group, "empty", "");
  addNumbers(group, "run", {0.25}, true);
  const hid_t travel = H5Dopen2(file, "travel", H5P_DEFAULT);
  addVariableText(travel, "unit", "m");
  H5Dclose(travel);
  H5Gclose(group);
  H5Fclose(file);
  const ForceTable table = loadForceTable(path);
  EXPECT_EQ(table.provenance.at("note"), "checked against the bench, \xc3\xa4");
  EXPECT_EQ(table.provenance.at("empty"), "");
  EXPECT_EQ(table.provenance.at("run"), "0.25");
  EXPECT_EQ(table.provenance.at("rung"), "closed form");

  file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  group = H5Gopen2(file, "provenance", H5P_DEFAULT);
  addNumbers(group, "several", {1, 2, 3}, false);
  H5Gclose(group);
  H5Fclose(file);
  try {
    loadForceTable(path);
    ADD_FAILURE() << "was accepted";
  } catch (const common::FileError& e) {
    EXPECT_NE(std::string(e.what()).find("attribute several is neither one text nor one number"), std::string::npos)
        << e.what();
  }
}

/// A filter that only the writer has, as h5py's LZF: its name is what the reader can act on.
TEST(ForceTable, AFilterThatIsNotHereIsNamed) {
  const std::string path = ::testing::TempDir() + "other_filter.h5";
  saveForceTable(cubicTable(), path);
  constexpr H5Z_filter_t NUMBER = 32000;
  const H5Z_class2_t filter = {
      H5Z_CLASS_T_VERS,
      NUMBER,
      1,
      1,
      "lzf",
      nullptr,
      nullptr,
      [](unsigned, std::size_t, const unsigned*, std::size_t bytes, std::size_t*, void**) { return bytes; }};
  ASSERT_GE(H5Zregister(&filter), 0);
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), old = H5Dopen2(file, "travel", H5P_DEFAULT);
  const hid_t space = H5Dget_space(old), settings = H5Pcreate(H5P_DATASET_CREATE);
  const hsize_t count = static_cast<hsize_t>(H5Sget_simple_extent_npoints(space));
  const std::vector<double> values(count, 0.0);
  H5Dclose(old);
  H5Ldelete(file, "travel", H5P_DEFAULT);
  H5Pset_chunk(settings, 1, &count);
  ASSERT_GE(H5Pset_filter(settings, NUMBER, H5Z_FLAG_MANDATORY, 0, nullptr), 0);
  const hid_t made = H5Dcreate2(file, "travel", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, settings, H5P_DEFAULT);
  ASSERT_GE(H5Dwrite(made, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
  addVariableText(made, "unit", "m");
  H5Dclose(made);
  H5Pclose(settings);
  H5Sclose(space);
  H5Fclose(file);
  ASSERT_GE(H5Zunregister(NUMBER), 0);
  try {
    loadForceTable(path);
    ADD_FAILURE() << "was accepted";
  } catch (const common::FileError& e) {
    EXPECT_NE(std::string(e.what()).find("'travel' is compressed by the filter 'lzf'"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace snapwing::vehicle
