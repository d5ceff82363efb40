// Energies and forces of a body whose material is an affine image of its grid, and their derivatives by the map.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "snapwing/common/error.h"
#include "snapwing/elasticity/neo_hookean.h"
#include "snapwing/mpm/map_derivative.h"

namespace snapwing::mpm {
namespace {

using elasticity::Matrix;
using elasticity::Order;

template <int D>
Discretisation<D> mapped(const Matrix<D>& map) {
  Discretisation<D> solid;
  const int law = solid.addModel(std::make_shared<elasticity::NeoHookean<D>>(
      elasticity::Material{2e3, 0.3, 1000}, elasticity::DensityInterpolation{}, elasticity::Plane::STRESS));
  Grid<D> grid;
  grid.cell_size = 0.5;
  for (int a = 0; a < D; ++a) grid.cells[a] = 3 - a % 2;
  grid.kernel = Kernel::QUADRATIC;
  QuadratureRule<D> rule = gaussRule<D>(grid, 2);
  mapRule<D>(map, &rule);
  const int kind = solid.addKind({{solid.addRule(rule), law}});
  solid.addBody(grid);
  for (int c = 0; c < grid.cellCount(); ++c) {
    solid.addCell(grid.cellIndex(c), {kind, 1, std::pow(0.5, D) * map.determinant()});
  }
  solid.finish();
  return solid;
}

template <int D>
Matrix<D> someMap() {
  Matrix<D> map = Matrix<D>::Identity();
  map(0, 0) = 1.7;
  map(0, 1) = -0.4;
  map(1, 0) = 0.6;
  return map;
}

template <int D>
Assembly assembled(const Discretisation<D>& solid, const Eigen::VectorXd& u) {
  Assembly at;
  solid.assemble(u, Order::STRESS, 1, at);
  EXPECT_TRUE(at.finite);
  return at;
}

template <int D>
double worstError(double step) {
  const Matrix<D> map = someMap<D>();
  const Discretisation<D> solid = mapped<D>(map);
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> number(-0.05, 0.05);
  Eigen::VectorXd u(solid.dofCount());
  for (int i = 0; i < u.size(); ++i) u[i] = number(rng);
  std::vector<Matrix<D>> slopes, rates;
  for (int k = 0; k < D * D; ++k) {
    slopes.push_back(Matrix<D>::Zero());
    slopes.back()(k % D, k / D) = 1;
    rates.push_back(slopes.back() * map.inverse());
  }
  const MapDerivative<D> derivative = mapDerivative<D>(solid, u, {rates});
  double worst = 0;
  for (int k = 0; k < D * D; ++k) {
    const Assembly high = assembled<D>(mapped<D>(map + step * slopes[k]), u),
                   low = assembled<D>(mapped<D>(map - step * slopes[k]), u);
    worst = std::max(
        worst, std::abs((high.energy - low.energy) / (2 * step) - derivative.energy[k]) / derivative.energy.norm());
    worst = std::max(worst, ((high.gradient - low.gradient) / (2 * step) - derivative.force.col(k)).norm() /
                                derivative.force.norm());
  }
  return worst;
}

TEST(MapDerivative, MatchesDifferencesOverSeveralSteps) {
  for (const auto& errorAt : {worstError<2>, worstError<3>}) {
    const double coarse = errorAt(1e-3), fine = errorAt(1e-4), finest = errorAt(1e-5);
    EXPECT_NEAR(coarse / fine, 100, 2);  // second order
    EXPECT_LT(finest, 1e-8);
  }
}

TEST(MapDerivative, ARigidTurnOfTheImageCostsNothing) {
  // u = (R - 1) X at nodes X = A xi: the linear field is reproduced, so that the energy vanishes on any image.
  const Matrix<2> map = someMap<2>();
  const Discretisation<2> solid = mapped<2>(map);
  Matrix<2> turn;
  turn << std::cos(2.0), -std::sin(2.0), std::sin(2.0), std::cos(2.0);
  Eigen::VectorXd u(solid.dofCount());
  for (int n = 0; n < solid.nodeCount(); ++n) {
    u.segment<2>(2 * n) = (turn - Matrix<2>::Identity()) * map * solid.position(n);
  }
  EXPECT_NEAR(assembled<2>(solid, u).energy, 0, 1e-12);
}

TEST(MapDerivative, RefusesMapsThatTurnInsideOutAndWrongSizes) {
  Matrix<2> mirrored = Matrix<2>::Identity();
  mirrored(0, 0) = -1;
  EXPECT_THROW(mapped<2>(mirrored), common::Error);
  const Discretisation<2> solid = mapped<2>(Matrix<2>::Identity());
  EXPECT_THROW(mapDerivative<2>(solid, Eigen::VectorXd::Zero(3), {{Matrix<2>::Identity()}}), common::Error);
}

}  // namespace
}  // namespace snapwing::mpm
