// What the hot loops of one thread work on (private to the layer).
#pragma once

#include <limits>
#include <vector>

#include "snapwing/mpm/discretisation.h"

namespace snapwing::mpm {

template <int D>
struct Discretisation<D>::CellResult {
  double energy = 0;
  double force_squared = 0;
  double min_det_f = std::numeric_limits<double>::infinity();
  bool finite = true;
};

/// Of a batch of cells side by side.
template <int D>
struct Discretisation<D>::LaneScratch {
  using Lanes = elasticity::Lanes;
  explicit LaneScratch(int stencil)
      : moved(D * stencil), force(D * stencil), matrix(stencil * (stencil + 1) / 2 * D * D), rows(3 * D * stencil) {}
  std::vector<Lanes> moved, force;  ///< [a][i]
  std::vector<Lanes> matrix;        ///< K_ab(i,k) for b <= a, as [a][b][i D + k]
  std::vector<Lanes> rows;          ///< Q grad N_a, and it times w b and w c: [3][a][i]
  elasticity::PointLanes<D> points;
  elasticity::ResponseLanes<D> response;
  Lanes measure, energy, min_det_f;
};

}  // namespace snapwing::mpm
