#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "snapwing/common/error.h"
#include "snapwing/common/force_table.h"
#include "snapwing/common/provenance.h"

namespace snapwing::common {
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
    t.stable.push_back(1);
    t.iterations.push_back(4);
  }
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
  EXPECT_THROW(saveForceTable(t, path), Error);
  EXPECT_FALSE(std::filesystem::exists(path));
  t = cubicTable();
  std::swap(t.travel[3], t.travel[4]);
  EXPECT_THROW(t.validate(), Error);
  EXPECT_THROW(loadForceTable(path), FileError);
  writeFileAtomically(path, "no HDF5");
  EXPECT_THROW(loadForceTable(path), FileError);
  writeFileAtomically(path, "");
  EXPECT_THROW(loadForceTable(path), FileError);
  std::filesystem::remove(path);
}

TEST(ForceTable, FailedSaveLeavesTheOldFile) {
  const std::string folder = testing::TempDir() + "table_folder";
  std::filesystem::create_directory(folder);
  const std::string path = folder + "/t.h5";
  saveForceTable(cubicTable(), path);
  const std::string before = sha256OfFile(path);
  ForceTable broken = cubicTable();
  broken.energy.pop_back();
  EXPECT_THROW(saveForceTable(broken, path), Error);
  EXPECT_EQ(sha256OfFile(path), before);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace snapwing::common
