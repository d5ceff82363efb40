// Cells whose law is linear, as void is: their Hessian is summed once, and their forces are its product with u.
#include <algorithm>
#include <cmath>

#include "assembly_lanes.h"
#include "snapwing/common/wide.h"
#include "stencil.h"

namespace snapwing::mpm {

using elasticity::Lanes;
using elasticity::LANES;
using elasticity::Order;

namespace {

/// force = m s K u and u . force, of cells side by side.
template <int DOF>
SNAPWING_WIDE void multiplyLanes(const double* __restrict matrix, const Lanes& __restrict scale,
                                 const Lanes* __restrict moved, Lanes* __restrict force, Lanes& __restrict work) {
  for (int r = 0; r < DOF; ++r) {
#pragma omp simd
    for (int l = 0; l < LANES; ++l) {
      double sum = 0;
      for (int c = 0; c < DOF; ++c) sum += matrix[r * DOF + c] * moved[c].at[l];
      force[r].at[l] = scale.at[l] * sum;
      work.at[l] += force[r].at[l] * moved[r].at[l];
    }
  }
}

}  // namespace

/// All terms of a linear cell have one stiffness s: then its Hessian is that of its kind, times m s.
template <int D>
bool Discretisation<D>::linearCell(int number) const {
  const std::vector<Term>& terms = kinds_[cells_[number].kind];
  const auto* values = &prepared_[static_cast<std::size_t>(number) * most_terms_];
  for (std::size_t t = 0; t < terms.size(); ++t) {
    if (!models_[terms[t].model]->linear(values[t]) || values[t].stiffness != values[0].stiffness) return false;
  }
  return true;
}

/// Hessian of a linear cell of a kind at m = s = 1, [a][i][b][k].
template <int D>
std::vector<double> Discretisation<D>::linearHessian(int kind) const {
  const int row = paddedStencil(stencil_), dofs = D * stencil_;
  std::vector<double> matrix(static_cast<std::size_t>(dofs) * dofs, 0.0);
  for (const Term& term : kinds_[kind]) {
    const elasticity::SharedTangent shared = models_[term.model]->shared({1, 0, 0, 0}, Order::TANGENT);
    const RuleTable& table = tables_[term.rule];
    for (int a = 0; a < stencil_; ++a) {
      for (int i = 0; i < D; ++i) {
        for (int b = 0; b <= a; ++b) {
          for (int k = 0; k < D; ++k) {
            double value = i == k ? shared.a * table.laplace[a * row + b] : 0;
            if (!table.outer.empty()) {
              value += shared.b * table.outer[((a * D + i) * D + k) * row + b] +
                       shared.c * table.outer[((a * D + k) * D + i) * row + b];
            }
            matrix[(D * a + i) * dofs + D * b + k] += value;
            if (a != b) matrix[(D * b + k) * dofs + D * a + i] += value;
          }
        }
      }
    }
  }
  return matrix;
}

template <int D>
void Discretisation<D>::prepareLinearCells() {
  linear_.assign(kinds_.size(), {});
  linear_blocks_.clear();
  const int pairs = stencil_ * (stencil_ + 1) / 2, dofs = D * stencil_;
  for (int number = 0; number < cellCount(); ++number) {
    if (!linearCell(number)) continue;
    std::vector<double>& matrix = linear_[cells_[number].kind];
    if (matrix.empty()) matrix = linearHessian(cells_[number].kind);
    linear_blocks_.resize(static_cast<std::size_t>(pattern_.blocks()) * D * D, 0.0);
    const double scale = cells_[number].measure * prepared_[static_cast<std::size_t>(number) * most_terms_].stiffness;
    const int* pair = block_of_pair_.data() + static_cast<std::size_t>(number) * pairs;
    for (int a = 0; a < stencil_; ++a) {
      for (int b = 0; b <= a; ++b, ++pair) {
        double* block = linear_blocks_.data() + static_cast<std::size_t>(*pair) * D * D;
        for (int i = 0; i < D; ++i) {
          for (int k = 0; k < D; ++k) block[i + D * k] += scale * matrix[(D * a + i) * dofs + D * b + k];
        }
      }
    }
  }
}

template <int D>
template <int S>
void Discretisation<D>::evaluateLinear(const Batch& batch, const Eigen::VectorXd& u, LaneScratch& scratch,
                                       CellResult* results) const {
  LaneScratch& s = scratch;
  for (int l = 0; l < LANES; ++l) {
    const int number = batch.cells[l];
    const int* nodes = cellNodes(number);
    for (int a = 0; a < S; ++a) {
      for (int i = 0; i < D; ++i) s.moved[D * a + i].at[l] = u(D * nodes[a] + i);
    }
    s.measure.at[l] = cells_[number].measure * prepared_[static_cast<std::size_t>(number) * most_terms_].stiffness;
    s.energy.at[l] = 0;
  }
  const std::vector<double>& matrix = linear_[cells_[batch.cells[0]].kind];
  multiplyLanes<D * S>(matrix.data(), s.measure, s.moved.data(), s.force.data(), s.energy);
  for (int l = 0; l < batch.count; ++l) {
    CellResult& r = results[batch.cells[l]];
    r.energy = 0.5 * s.energy.at[l];
    r.min_det_f = 1;  // of F = I + 0 H, which is what the law sees
    r.finite = std::isfinite(r.energy);
    r.force_squared = 0;
    for (const Lanes& component : s.force) r.force_squared += component.at[l] * component.at[l];
  }
}

#define SNAPWING_LINEAR(D, S)                                                                                         \
  template void Discretisation<D>::evaluateLinear<S>(const Batch&, const Eigen::VectorXd&, LaneScratch&, CellResult*) \
      const;
SNAPWING_LINEAR(2, LINEAR_STENCIL<2>)
SNAPWING_LINEAR(2, QUADRATIC_STENCIL<2>)
SNAPWING_LINEAR(3, LINEAR_STENCIL<3>)
SNAPWING_LINEAR(3, QUADRATIC_STENCIL<3>)
#undef SNAPWING_LINEAR
template void Discretisation<2>::prepareLinearCells();
template void Discretisation<3>::prepareLinearCells();
template bool Discretisation<2>::linearCell(int) const;
template bool Discretisation<3>::linearCell(int) const;

}  // namespace snapwing::mpm
