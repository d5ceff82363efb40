#pragma once
/// A small rubber block of cells and shapes that it may take, for tests of terms.

#include <cmath>
#include <memory>

#include "snapwing/elasticity/neo_hookean.h"
#include "snapwing/mpm/discretisation.h"

namespace snapwing::test {

constexpr double BLOCK_CELL = 0.01;       // [m]
constexpr double BLOCK_DENSITY = 1200.0;  // [kg/m3]

/// One body of 4 x 3 (x 2) cells.
template <int D>
std::shared_ptr<mpm::Discretisation<D>> block(elasticity::Plane plane = elasticity::Plane::STRAIN) {
  auto solid = std::make_shared<mpm::Discretisation<D>>();
  mpm::Grid<D> grid;
  grid.kernel = mpm::Kernel::LINEAR;
  grid.cell_size = BLOCK_CELL;
  grid.cells[0] = 4, grid.cells[1] = 3;
  if constexpr (D == 3) grid.cells[2] = 2;
  const elasticity::Material material{5.5e6, 0.45, BLOCK_DENSITY};
  const int model =
      solid->addModel(std::make_shared<elasticity::NeoHookean<D>>(material, elasticity::DensityInterpolation{}, plane));
  const int rule = solid->addRule(mpm::gaussRule(grid, 2));
  const int kind = solid->addKind({{rule, model}});
  solid->addBody(grid);
  for (int c = 0; c < grid.cellCount(); ++c) {
    solid->addCell(grid.cellIndex(c), {kind, 1.0, std::pow(BLOCK_CELL, D)});
  }
  solid->finish();
  return solid;
}

inline Eigen::VectorXd wavy(int size, double amplitude, double phase) {
  Eigen::VectorXd y(size);
  for (int k = 0; k < size; ++k) y(k) = amplitude * std::sin(1.7 * k + phase);
  return y;
}

}  // namespace snapwing::test
