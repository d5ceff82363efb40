// Strains of cells and their means over a fixed length, against closed forms.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "snapwing/common/error.h"
#include "snapwing/elasticity/neo_hookean.h"
#include "snapwing/mpm/cell_values.h"
#include "support/block.h"

namespace snapwing::mpm {
namespace {

constexpr double RADIUS = 1e-3, PI = 3.14159265358979323846;

/// Material of a cell by its index: density, and thickness beside 1.
struct Filling {
  double density = 1, thickness = 1;
};

/// A bar of full cells in the plane, 20 x 4 mm unless told.
template <class FillingAt>
Discretisation<2> bar(double cell, const FillingAt& filling, double length = 0.02, double height = 0.004) {
  Discretisation<2> solid;
  Grid<2> grid;
  grid.cell_size = cell;
  grid.cells = {static_cast<int>(std::lround(length / cell)), static_cast<int>(std::lround(height / cell))};
  const int model = solid.addModel(std::make_shared<elasticity::NeoHookean<2>>(
      elasticity::Material{5.5e6, 0.48, 1210}, elasticity::DensityInterpolation{}, elasticity::Plane::STRESS));
  const int kind = solid.addKind({{solid.addRule(gaussRule(grid, 2)), model}});
  solid.addBody(grid);
  for (int c = 0; c < grid.cellCount(); ++c) {
    const Index<2> at = grid.cellIndex(c);
    const Filling with = filling(at);
    solid.addCell(at, {kind, with.density, with.thickness * cell * cell});
  }
  solid.finish();
  return solid;
}

Filling solidEverywhere(const Index<2>& /*at*/) { return {}; }

template <class Map>
Eigen::VectorXd moved(const Discretisation<2>& solid, const Map& map) {
  Eigen::VectorXd u(solid.dofCount());
  for (int n = 0; n < solid.nodeCount(); ++n) u.segment<2>(2 * n) = map(solid.position(n)) - solid.position(n);
  return u;
}

double largestMean(const Discretisation<2>& solid, const Eigen::VectorXd& strains) {
  return (meansWithin(solid, RADIUS) * strains).maxCoeff();
}

/// In uniform tension, in any axes, every cell and every mean has the stretch less one.
TEST(CellValues, UniformTension) {
  constexpr double STRETCH = 1.3;
  for (const double cell : {2e-3, 1e-3, 0.5e-3}) {
    const Discretisation<2> solid = bar(cell, solidEverywhere);
    const Eigen::Matrix2d turned = Eigen::Rotation2Dd(0.7).toRotationMatrix();
    const Eigen::VectorXd strains = cellStrains(solid, moved(solid, [&](const Vector<2>& x) -> Vector<2> {
                                                  return turned * Vector<2>(STRETCH * x(0), 0.9 * x(1));
                                                }));
    EXPECT_NEAR(strains.maxCoeff(), STRETCH - 1, 1e-12);
    EXPECT_NEAR(strains.minCoeff(), STRETCH - 1, 1e-12);
    const Eigen::VectorXd means = meansWithin(solid, RADIUS) * strains;
    EXPECT_NEAR(means.maxCoeff(), STRETCH - 1, 1e-12);
    EXPECT_NEAR(means.minCoeff(), STRETCH - 1, 1e-12);
  }
}

TEST(CellValues, UniformTensionOfASolid) {
  const auto solid = test::block<3>();
  Eigen::VectorXd u = Eigen::VectorXd::Zero(solid->dofCount());
  for (int n = 0; n < solid->nodeCount(); ++n) u(3 * n + 2) = 0.2 * solid->position(n)(2);
  const Eigen::VectorXd means = meansWithin(*solid, 1.7 * test::BLOCK_CELL) * cellStrains(*solid, u);
  EXPECT_NEAR(means.maxCoeff(), 0.2, 1e-12);
  EXPECT_NEAR(means.minCoeff(), 0.2, 1e-12);
  EXPECT_NEAR(cellVolumes(*solid).sum(), 24 * std::pow(test::BLOCK_CELL, 3), 1e-18);
}

/// Distance of the centroid of a disc's part below a line from the disc's centre. @param depth  of the centre below it
double centroidBelow(double depth) {
  const double half = std::sqrt(RADIUS * RADIUS - depth * depth);
  const double area = RADIUS * RADIUS * (PI - std::acos(depth / RADIUS)) + depth * half;
  return 2 * half * half * half / (3 * area);
}

/// A bar bent to a circle has the strain y / R. The largest mean is that of the outermost cells, whose disc the surface
/// cuts off: the strain at the rest's centroid. It tends to the surface's strain less 4 RADIUS / (3 pi R).
TEST(CellValues, BentBar) {
  constexpr double BEND = 0.04, HALF = 0.002;  // [m]
  for (const double cell : {0.5e-3, 0.25e-3, 0.125e-3}) {
    const Discretisation<2> solid = bar(cell, solidEverywhere);
    const Eigen::VectorXd strains = cellStrains(solid, moved(solid, [](const Vector<2>& x) {
                                                  const double radius = BEND + x(1) - HALF, angle = x(0) / BEND;
                                                  return Vector<2>(radius * std::sin(angle), radius * std::cos(angle));
                                                }));
    // A cell's straight edges are shorter than its arcs by angle^2 / 24.
    const double chord = std::pow(cell / BEND, 2) / 20;
    EXPECT_NEAR(strains.maxCoeff(), (HALF - cell / 2) / BEND, chord);
    const double expected = (HALF - cell / 2 - centroidBelow(cell / 2)) / BEND;
    // A cell that the disc cuts counts with its centre's strain, not that of the part inside: an error of second order.
    EXPECT_NEAR(largestMean(solid, strains), expected, chord + 0.125 * cell * cell / (RADIUS * BEND)) << cell;
    EXPECT_LT(largestMean(solid, strains), strains.maxCoeff() - 0.2 * RADIUS / BEND);
  }
}

/// Two halves, of which the left one is stretched alone: where they meet a mean holds as much of each as its material
/// has of the whole, by density and by volume.
TEST(CellValues, MeansAreOfTheMaterial) {
  constexpr double CELL = 1e-3;
  constexpr int MIDDLE = 10;
  const auto meanAtTheEdge = [&](const Filling& left, const Filling& right) {
    const Discretisation<2> solid = bar(
        CELL, [&](const Index<2>& at) { return at[0] < MIDDLE ? left : right; }, 0.02, 0.004);
    Eigen::VectorXd values(solid.cellCount());
    for (int c = 0; c < solid.cellCount(); ++c) values(c) = solid.cellAt(c)[0] < MIDDLE ? 1 : 0;
    return (meansWithin(solid, RADIUS) * values)(solid.findCell(0, {MIDDLE, 2}));
  };
  const double beyond = std::acos(0.5) - 0.5 * std::sqrt(0.75);  // of a disc, half its radius from the centre
  const auto share = [&](double left, double right) { return left * beyond / (left * beyond + right * (PI - beyond)); };
  EXPECT_NEAR(meanAtTheEdge({1, 1}, {1, 1}), share(1, 1), 2e-3);
  EXPECT_NEAR(meanAtTheEdge({1, 1}, {0.2, 1}), share(1, 0.2), 2e-3) << "density";
  EXPECT_NEAR(meanAtTheEdge({1, 2}, {1, 1}), share(2, 1), 2e-3) << "volume";
  EXPECT_GT(share(1, 0.2) - share(1, 1), 0.2);
  EXPECT_GT(share(2, 1) - share(1, 1), 0.1);
}

/// The strain of a corner's field, s = r^-0.46, at the cells' centres grows with smaller cells; its mean has the limit
/// (2 / 1.54) RADIUS^-0.46 about the corner.
TEST(CellValues, TheMeanOfASingularStrainConverges) {
  constexpr double POWER = -0.4555;
  const auto both = [&](double cell) {
    const Discretisation<2> solid = bar(cell, solidEverywhere, 0.008, 0.008);
    Eigen::VectorXd values(solid.cellCount());
    for (int c = 0; c < solid.cellCount(); ++c) {
      values(c) =
          std::pow((solid.grid(0).cellCentre(solid.cellAt(c)) - Vector<2>(0.004, 0.004)).norm() / RADIUS, POWER);
    }
    return std::pair(values.maxCoeff(), largestMean(solid, values));
  };
  const double limit = 2 / (2 + POWER);
  const auto coarse = both(0.5e-3), fine = both(0.25e-3), finest = both(0.125e-3);
  EXPECT_NEAR(fine.first / coarse.first, std::pow(2, -POWER), 1e-6);
  EXPECT_NEAR(finest.second, limit, 0.02 * limit);
  EXPECT_LT(std::abs(finest.second - limit), 0.5 * std::abs(coarse.second - limit));
}

TEST(CellValues, CellsOfTwiceTheRadiusAreTheirOwnMean) {
  const Discretisation<2> solid = bar(2 * RADIUS, solidEverywhere);
  EXPECT_EQ(meansWithin(solid, RADIUS).nonZeros(), solid.cellCount());
  EXPECT_THROW(meansWithin(solid, 0), common::Error);
}

/// Where there is no material, there is no mean.
TEST(CellValues, EmptyRows) {
  const Discretisation<2> solid = bar(1e-3, [](const Index<2>& at) { return Filling{at[0] < 10 ? 0.0 : 1.0, 1}; });
  const auto means = meansWithin(solid, RADIUS);
  EXPECT_EQ(means.row(solid.findCell(0, {5, 2})).nonZeros(), 0);
  EXPECT_NEAR(means.row(solid.findCell(0, {15, 2})).sum(), 1, 1e-12);
}

}  // namespace
}  // namespace snapwing::mpm
