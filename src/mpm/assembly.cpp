// Energy, gradient and Hessian of all cells: side by side where the law can, else one after the other.
#include <algorithm>
#include <cmath>

#include "assembly_lanes.h"
#include "snapwing/common/wide.h"
#include "snapwing/mpm/discretisation.h"
#include "stencil.h"

namespace snapwing::mpm {

using elasticity::Order;

/// Cell Hessian as [a][i D + k][b], b <= a in rows of whole vectors, which is what the compiler turns into SIMD code.
/// What is beyond b = a is never read.
template <int D>
struct Discretisation<D>::Scratch {
  explicit Scratch(int stencil)
      : matrix(static_cast<std::size_t>(stencil) * D * D * paddedStencil(stencil)), force(stencil * D) {}
  std::vector<double> matrix;
  std::vector<double> force;  ///< [a][i]
};

namespace {

/// Entries of a row that whole vectors of four make of b <= a.
template <int S>
constexpr int entries(int a) {
  return (a / 4 + 1) * 4 < paddedStencil(S) ? (a / 4 + 1) * 4 : paddedStencil(S);
}

/// K_ab(i,k) += diagonal d_ik L_ab, and b0 T_ab(i,k) + c0 T_ab(k,i) if there is such a part
template <int D, int S>
SNAPWING_WIDE void addTables(double diagonal, double b0, double c0, const double* __restrict laplace,
                             const double* __restrict outer, double* __restrict matrix) {
  constexpr int ROW = paddedStencil(S);
  for (int a = 0; a < S; ++a) {
    const int count = entries<S>(a);
    for (int i = 0; i < D; ++i) {
      for (int k = 0; k < D; ++k) {
        double* row = matrix + ((a * D + i) * D + k) * ROW;
        if (i == k) {
          for (int n = 0; n < count; ++n) row[n] += diagonal * laplace[a * ROW + n];
        }
        if (b0 == 0 && c0 == 0) continue;
        const double* same = outer + ((a * D + i) * D + k) * ROW;
        const double* swapped = outer + ((a * D + k) * D + i) * ROW;
        for (int n = 0; n < count; ++n) row[n] += b0 * same[n] + c0 * swapped[n];
      }
    }
  }
}

template <int D, int S>
void addFull(const elasticity::FullTangent<D>& t, double w, const double* g, double* matrix) {
  constexpr int ROW = paddedStencil(S);
  for (int a = 0; a < S; ++a) {
    for (int i = 0; i < D; ++i) {
      for (int k = 0; k < D; ++k) {
        double* row = matrix + ((a * D + i) * D + k) * ROW;
        for (int l = 0; l < D; ++l) {
          double factor = 0;
          for (int j = 0; j < D; ++j) factor += g[D * a + j] * t(i + D * j, k + D * l);
          factor *= w;
          for (int n = 0; n <= a; ++n) row[n] += factor * g[D * n + l];
        }
      }
    }
  }
}

}  // namespace

template <int D>
template <int S>
typename Discretisation<D>::CellResult Discretisation<D>::evaluateCell(int number, const Eigen::VectorXd& u,
                                                                       Order order, Scratch& scratch) const {
  const Cell& cell = cells_[number];
  const int* nodes = cellNodes(number);
  Eigen::Matrix<double, D, S> moved;
  for (int a = 0; a < S; ++a) moved.col(a) = u.template segment<D>(D * nodes[a]);
  const bool tangent = elasticity::withTangent(order);
  if (tangent) std::fill(scratch.matrix.begin(), scratch.matrix.end(), 0.0);
  Eigen::Matrix<double, D, S> force = Eigen::Matrix<double, D, S>::Zero();
  CellResult result;
  elasticity::Response<D> response;
  const std::vector<Term>& terms = kinds_[cell.kind];
  for (std::size_t t = 0; t < terms.size(); ++t) {
    const QuadratureRule<D>& rule = rules_[terms[t].rule];
    const Model& law = *models_[terms[t].model];
    const elasticity::DensityInterpolation::Value& state =
        prepared_[static_cast<std::size_t>(number) * most_terms_ + t];
    for (int p = 0; p < rule.size(); ++p) {
      const Eigen::Map<const Eigen::Matrix<double, D, S>> slope(rule.slopeOf(p));
      const elasticity::Matrix<D> f = elasticity::Matrix<D>::Identity() + moved * slope.transpose();
      const bool good = law.evaluatePrepared(f, state, order, response);
      result.min_det_f = std::min(result.min_det_f, response.det_f);
      const double w = cell.measure * rule.weight[p];
      result.energy += w * response.energy;
      if (!good || !std::isfinite(result.energy)) {
        result.finite = false;
        return result;
      }
      if (order == Order::ENERGY) continue;
      force += w * response.stress * slope;
      if (!tangent) continue;
      if (response.compact) response.full = elasticity::fullTangent<D>({}, response);
      addFull<D, S>(response.full, w, rule.slopeOf(p), scratch.matrix.data());
    }
    if (!tangent) continue;
    const elasticity::SharedTangent shared = law.shared(state, order);
    if (shared.a == 0 && shared.b == 0 && shared.c == 0) continue;
    const RuleTable& table = tables_[terms[t].rule];
    addTables<D, S>(cell.measure * shared.a, cell.measure * shared.b, cell.measure * shared.c, table.laplace.data(),
                    table.outer.data(), scratch.matrix.data());
  }
  result.force_squared = force.squaredNorm();
  Eigen::Map<Eigen::Matrix<double, D, S>>(scratch.force.data()) = force;
  return result;
}

template <int D>
template <int S>
void Discretisation<D>::scatter(int number, Order order, const Scratch& scratch, Assembly& out) const {
  const int* nodes = cellNodes(number);
  for (int a = 0; a < S; ++a) {
    for (int i = 0; i < D; ++i) out.gradient(D * nodes[a] + i) += scratch.force[D * a + i];
  }
  if (order == Order::STRESS) return;
  const int* pair = block_of_pair_.data() + static_cast<std::size_t>(number) * (S * (S + 1) / 2);
  for (int a = 0; a < S; ++a) {
    const double* rows = scratch.matrix.data() + static_cast<std::size_t>(a) * D * D * paddedStencil(S);
    for (int b = 0; b <= a; ++b, ++pair) {
      double* block = out.blocks.data() + static_cast<std::size_t>(*pair) * D * D;
      for (int i = 0; i < D; ++i) {
        for (int k = 0; k < D; ++k) block[i + D * k] += rows[(i * D + k) * paddedStencil(S) + b];
      }
    }
  }
}

template <int D>
template <int S>
void Discretisation<D>::assembleCells(const Eigen::VectorXd& u, Order order, int threads, Assembly& out) const {
  std::vector<CellResult> results(cells_.size());
#pragma omp parallel num_threads(threads) if (threads > 1)
  {
    Scratch scratch(S);
    LaneScratch lanes(S);
    for (const std::vector<Batch>& colour : batches_) {
      const int count = static_cast<int>(colour.size());
#pragma omp for schedule(static)
      for (int n = 0; n < count; ++n) {
        const Batch& batch = colour[n];
        if (batch.linear) {
          evaluateLinear<S>(batch, u, lanes, results.data());
          if (order != Order::ENERGY) scatterBatch<S>(batch, Order::STRESS, lanes, results.data(), out);
          continue;
        }
        if (inLanes(cells_[batch.cells[0]].kind, order)) {
          evaluateBatch<S>(batch, u, order, lanes, results.data());
          if (order != Order::ENERGY) scatterBatch<S>(batch, order, lanes, results.data(), out);
          continue;
        }
        for (int l = 0; l < batch.count; ++l) {
          const int cell = batch.cells[l];
          results[cell] = evaluateCell<S>(cell, u, order, scratch);
          if (order != Order::ENERGY && results[cell].finite) scatter<S>(cell, order, scratch, out);
        }
      }
    }
  }
  double force_squared = 0;
  for (int c = 0; c < cellCount(); ++c) {
    const CellResult& r = results[c];
    out.energy += r.energy;
    force_squared += r.force_squared;
    out.finite = out.finite && r.finite;
    if (r.min_det_f < out.min_det_f || std::isnan(r.min_det_f)) {
      out.min_det_f = r.min_det_f;
      out.min_det_f_cell = c;
    }
  }
  out.force_scale = std::sqrt(force_squared);
}

/// With the Hessian of the linear cells, which is the same at every order.
template <int D>
void Discretisation<D>::startBlocks(Assembly& out) const {
  const std::size_t size = static_cast<std::size_t>(pattern_.blocks()) * D * D;
  if (out.add_blocks) {
    for (std::size_t k = 0; k < linear_blocks_.size(); ++k) out.blocks[k] += linear_blocks_[k];
  } else if (linear_blocks_.empty()) {
    out.blocks.assign(size, 0.0);
  } else {
    out.blocks.assign(linear_blocks_.begin(), linear_blocks_.end());
  }
}

template <int D>
void Discretisation<D>::assemble(const Eigen::VectorXd& u, Order order, int threads, Assembly& out) const {
  out.energy = 0;
  out.finite = true;
  out.min_det_f = std::numeric_limits<double>::infinity();
  out.min_det_f_cell = -1;
  if (order != Order::ENERGY) out.gradient.setZero(dofCount());
  if (elasticity::withTangent(order)) startBlocks(out);
  if (stencil_ == LINEAR_STENCIL<D>) {
    assembleCells<LINEAR_STENCIL<D>>(u, order, threads, out);
  } else {
    assembleCells<QUADRATIC_STENCIL<D>>(u, order, threads, out);
  }
  if (!std::isfinite(out.energy)) out.finite = false;
}

template void Discretisation<2>::assemble(const Eigen::VectorXd&, Order, int, Assembly&) const;
template void Discretisation<3>::assemble(const Eigen::VectorXd&, Order, int, Assembly&) const;

}  // namespace snapwing::mpm
