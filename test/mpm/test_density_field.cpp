#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <utility>
#include <vector>

#include "snapwing/common/error.h"
#include "snapwing/elasticity/density_interpolation.h"
#include "snapwing/mpm/coarsening.h"
#include "snapwing/mpm/density_field.h"
#include "support/paths.h"

namespace snapwing::mpm {
namespace {

std::string writeFile(const std::string& name, const std::string& text) {
  const std::string path = ::testing::TempDir() + name;
  std::ofstream(path) << text;
  return path;
}

double area(const std::vector<std::array<double, 2>>& loop) {
  double sum = 0;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const auto &a = loop[k], &b = loop[(k + 1) % loop.size()];
    sum += 0.5 * (a[0] * b[1] - a[1] * b[0]);
  }
  return sum;
}

TEST(DensityField, ReadsTheShippedDesign) {
  const DensityField f = loadDensityCsv(test::sourceDir() + "/data/arms/arris_x220_study.csv", 0.08, 0.04);
  EXPECT_NEAR(f.cell_size, 1e-3, 1e-12);
  EXPECT_TRUE(f.present(79, 19));
  EXPECT_FALSE(f.present(20, 20));
  EXPECT_FALSE(f.present(-1, 0));
  double sum = 0;
  for (const double v : f.value) sum += std::max(0.0, v);
  // Coarser cells keep the amount of material.
  double coarse_sum = 0;
  const DensityField coarse = f.resampled(2e-3);
  for (const double v : coarse.value) coarse_sum += 4 * std::max(0.0, v);
  EXPECT_NEAR(sum, coarse_sum, 1e-9 * sum);
  EXPECT_THROW(f.resampled(0.7e-3), common::Error);
}

/// A disc of which the file lists the filled cells only: its mass, and what a file that lists the empty ones gives.
TEST(DensityField, CoarserCellsKeepTheMassOfARaggedBody) {
  DensityField sparse;
  sparse.cell_size = 0.5e-3;
  sparse.cells = {48, 36};
  for (int j = 0; j < 36; ++j) {
    for (int i = 0; i < 48; ++i) sparse.value.push_back(std::hypot(i - 20.2, 1.3 * (j - 17.6)) < 15 ? 0.9 : -1);
  }
  DensityField full = sparse;
  for (double& v : full.value) v = std::max(0.0, v);
  const auto mass = [](const DensityField& f) {
    double sum = 0;
    for (const double v : f.value) sum += std::max(0.0, v);
    return sum * f.cell_size * f.cell_size;
  };
  for (const double cell : {1e-3, 2e-3, 3e-3, 0.75e-3, 0.25e-3, 6e-3}) {
    const DensityField coarse = sparse.resampled(cell), listed = full.resampled(cell);
    EXPECT_NEAR(mass(coarse), mass(sparse), 1e-9 * mass(sparse)) << cell;
    for (std::size_t c = 0; c < coarse.value.size(); ++c) {
      EXPECT_NEAR(std::max(0.0, coarse.value[c]), listed.value[c], 1e-12) << cell;
    }
  }
}

TEST(DensityField, OutlineOfADiscHasItsArea) {
  DensityField f;
  f.cell_size = 1;
  f.cells = {40, 40};
  for (int j = 0; j < 40; ++j) {
    for (int i = 0; i < 40; ++i) {
      const double r = std::hypot(i + 0.5 - 20, j + 0.5 - 20);
      f.value.push_back(std::min(1.0, std::max(0.0, 0.5 + 12 - r)) * std::min(1.0, std::max(0.0, 0.5 + r - 6)));
    }
  }
  const auto loops = outline(f, 0.5);
  ASSERT_EQ(loops.size(), 2u);
  const double total = area(loops[0]) + area(loops[1]);  // outer counter-clockwise, inner clockwise
  EXPECT_NEAR(total, M_PI * (144 - 36), 0.01 * M_PI * 108);
}

TEST(DensityField, OutlineOfAFullDomainLiesOnItsFaces) {
  DensityField f;
  f.cell_size = 0.5;
  f.cells = {4, 2};
  f.value.assign(8, 1.0);
  const auto loops = outline(f, 0.5);
  ASSERT_EQ(loops.size(), 1u);
  EXPECT_NEAR(area(loops[0]), 2.0, 0.3);  // corners are cut by half a cell
  for (const auto& p : loops[0]) {
    EXPECT_TRUE(std::abs(p[0]) < 1e-12 || std::abs(p[0] - 2) < 1e-12 || std::abs(p[1]) < 1e-12 ||
                std::abs(p[1] - 1) < 1e-12);
  }
}

TEST(DensityField, RefusesBadFiles) {
  EXPECT_THROW(loadDensityCsv("no such file", 1, 1), common::FileError);
  EXPECT_THROW(loadDensityCsv(writeFile("a.csv", "x,y\n"), 1, 1), common::FileError);
  EXPECT_THROW(loadDensityCsv(writeFile("b.csv", "i,j,rho\n0,0,1.5\n"), 1, 1), common::FileError);
  EXPECT_THROW(loadDensityCsv(writeFile("c.csv", "i,j,rho\n0,0,1\n0,0,1\n"), 1, 1), common::FileError);
  EXPECT_THROW(loadDensityCsv(writeFile("d.csv", "i,j,rho\n0,0,1\n1,0,1\n"), 1, 1), common::FileError);
  EXPECT_THROW(loadDensityCsv(writeFile("e.csv", "i,j,rho\n0,zero,1\n"), 1, 1), common::FileError);
  EXPECT_NO_THROW(loadDensityCsv(writeFile("f.csv", "# c\ni,j,rho\n0,0,1\n1,0,0.5\n"), 2, 1));
}

/// What `action` is refused with.
template <class Action>
std::string refusalOf(Action action) {
  try {
    action();
  } catch (const common::FileError& e) {
    return e.what();
  }
  return "accepted";
}

/// What another program would read differently is refused with its line.
TEST(DensityCsv, RowsAreStrict) {
  const std::pair<const char*, const char*> cases[] = {
      {"i,j,rho\n0,0,1\n1,0,0,85\n", "line 3 is '1,0,0,85'; it has 4 fields"},
      {"i,j,rho\n0,0,1\n1,0,1abc\n", "line 3 is '1,0,1abc'"},
      {"i,j,rho\n0,0,1\n1;0;1\n", "line 3"},
      {"i,j,rho\n0,0,1\n1.0,0,1\n", "line 3"},
      {"i,j,rho\n0,0,1\n1,0,1.0000001\n", "'1,0,1.0000001'; allowed: rho in 0 .. 1"},
      {"i,j,rho\n0,0,1\n1,0,nan\n", "line 3"},
      {"i,j,rho\n0,0,1\n1,0,\n", "line 3"},
      {"i,j,rho\n0,0,1\n-1,0,1\n", "line 3"},
      {"i,j,rho\n0,0,1\n99999,0,1\n", "line 3"},
      {"i,j,rhombus\n0,0,1\n1,0,1\n", "first line is not 'i,j,rho': it is 'i,j,rhombus'"},
      {"i,j,rho,x\n0,0,1\n1,0,1\n", "first line is not 'i,j,rho'"},
      {"# only remarks\n", "the file has no line"},
      {"i,j,rho\n", "holds no cells"}};
  for (const auto& [text, part] : cases) {
    const std::string path = writeFile("strict.csv", text);
    const std::string refusal = refusalOf([&] { loadDensityCsv(path, 2, 1); });
    EXPECT_NE(refusal.find(part), std::string::npos) << text << refusal;
  }
  const std::string other =
      writeFile("windows.csv", "\xef\xbb\xbf# remark\r\ni, j, rho\r\n0,0,1\r\n 1 ,0,\t0.5\r\n\r\n");
  EXPECT_EQ(loadDensityCsv(other, 2, 1).value, (std::vector<double>{1, 0.5}));
}

/// Cells that are not listed are empty: a body in empty margins is not stretched over the domain.
TEST(DensityCsv, MarginsNeedTheNumberOfCells) {
  const std::string inner = writeFile("inner.csv", "i,j,rho\n1,1,1\n2,1,0.5\n1,2,1\n2,2,1\n");
  const std::string refusal = refusalOf([&] { loadDensityCsv(inner, 4, 4); });
  EXPECT_NE(refusal.find("no cell with i = 0"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("cells: [along x, along y]"), std::string::npos) << refusal;
  const DensityField field = loadDensityCsv(inner, 4, 4, {4, 4});
  EXPECT_DOUBLE_EQ(field.cell_size, 1);
  EXPECT_FALSE(field.present(0, 1));
  EXPECT_FALSE(field.present(3, 2));
  EXPECT_DOUBLE_EQ(field.at(2, 1), 0.5);
  EXPECT_NE(refusalOf([&] { loadDensityCsv(inner, 2, 2, {2, 2}); }).find("lists cells up to 3 x 3"), std::string::npos);
}

TEST(Density, CoarserCellsKeepTheMassOrTheStiffness) {
  DensityField field;
  field.cell_size = 1;
  field.cells = {2, 2};
  field.value = {1, 0.5, 0, -1};
  EXPECT_DOUBLE_EQ(field.resampled(2).at(0, 0), 1.5 / 4);
  EXPECT_DOUBLE_EQ(std::pow(field.resampled(2, 3).at(0, 0), 3), 1.125 / 4);
  EXPECT_EQ(coarseningPower(coarseningFromName("mass")), 1);
  EXPECT_EQ(coarseningPower(coarseningFromName("stiffness")), elasticity::DensityInterpolation().power);
  EXPECT_EQ(coarseningName(Coarsening::STIFFNESS), "stiffness");
  EXPECT_THROW(coarseningFromName("volume"), common::Error);
  field.value = {0.5, 0, 0, 0};  // a sliver of .031
  EXPECT_EQ(field.resampled(2, 3).at(0, 0), -1);
  EXPECT_GT(field.resampled(2).at(0, 0), 0);
  field.value = {1, 0.5, 0, -1};
  EXPECT_DOUBLE_EQ(field.resampled(0.5, 3).at(2, 0), 0.5);  // smaller cells are those of the field
  EXPECT_EQ(field.resampled(0.5, 3).at(3, 3), -1);
}

}  // namespace
}  // namespace snapwing::mpm
