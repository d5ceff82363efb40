// The hot loop: energy, gradient and Hessian of all cells.
#include <algorithm>
#include <cmath>

#include "snapwing/mpm/discretisation.h"
#include "stencil.h"

namespace snapwing::mpm {

using elasticity::Order;

/// Cell Hessian as [a][i D + k][b], b <= a in rows of whole vectors, which is what the compiler turns into SIMD code.
/// What is beyond b = a is never read.
template <int D>
struct Discretisation<D>::Scratch {
  explicit Scratch(int stencil)
      : matrix(static_cast<std::size_t>(stencil) * D * D * paddedStencil(stencil)),
        force(stencil * D),
        rows(D * paddedStencil(stencil)),
        turned(D * paddedStencil(stencil)) {}
  std::vector<double> matrix;
  std::vector<double> force;   ///< [a][i]
  std::vector<double> rows;    ///< grad N_a, by component
  std::vector<double> turned;  ///< Q grad N_a, by component
};

template <int D>
struct Discretisation<D>::CellResult {
  double energy = 0;
  double force_squared = 0;
  double min_det_f = std::numeric_limits<double>::infinity();
  bool finite = true;
};

namespace {

// Wider vectors where the machine has them. Multiply and add are never fused (-ffp-contract=off): the bits stay the
// same everywhere.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define SNAPWING_WIDE __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define SNAPWING_WIDE
#endif

/// Entries of a row that whole vectors of four make of b <= a.
template <int S>
constexpr int entries(int a) {
  return (a / 4 + 1) * 4 < paddedStencil(S) ? (a / 4 + 1) * 4 : paddedStencil(S);
}

/// K_ab(i,k) += c qb_i qa_k, and b qa_i qb_k if there is such a part
template <int D, int S>
SNAPWING_WIDE void addTurned(double b, double c, const double* __restrict q, double* __restrict matrix) {
  constexpr int ROW = paddedStencil(S);
  for (int a = 0; a < S; ++a) {
    const int count = entries<S>(a);
    double* rows = matrix + a * D * D * ROW;
    for (int i = 0; i < D; ++i) {
      for (int k = 0; k < D; ++k) {
        double* row = rows + (i * D + k) * ROW;
        const double* qi = q + i * ROW;
        const double* qk = q + k * ROW;
        const double cq = c * q[k * ROW + a], bq = b * q[i * ROW + a];
        if (b == 0) {
          for (int n = 0; n < count; ++n) row[n] += cq * qi[n];
        } else {
          for (int n = 0; n < count; ++n) row[n] += bq * qk[n] + cq * qi[n];
        }
      }
    }
  }
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
          for (int j = 0; j < D; ++j) factor += g[j * ROW + a] * t(i + D * j, k + D * l);
          factor *= w;
          for (int n = 0; n <= a; ++n) row[n] += factor * g[l * ROW + n];
        }
      }
    }
  }
}

/// out = M g^T by components, g as columns: rows of the kernel's gradients, turned by M.
template <int D, int S>
void turn(const elasticity::Matrix<D>& m, const double* __restrict slope, double* __restrict out) {
  constexpr int ROW = paddedStencil(S);
  for (int a = 0; a < S; ++a) {
    for (int i = 0; i < D; ++i) {
      double value = 0;
      for (int j = 0; j < D; ++j) value += m(i, j) * slope[D * a + j];
      out[i * ROW + a] = value;
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
      if (!response.compact) {
        turn<D, S>(elasticity::Matrix<D>::Identity(), rule.slopeOf(p), scratch.rows.data());
        addFull<D, S>(response.full, w, scratch.rows.data(), scratch.matrix.data());
      } else if (response.tangent.b != 0 || response.tangent.c != 0) {
        turn<D, S>(response.tangent.q, rule.slopeOf(p), scratch.turned.data());
        addTurned<D, S>(w * response.tangent.b, w * response.tangent.c, scratch.turned.data(), scratch.matrix.data());
      }
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
    for (const std::vector<int>& colour : colours_) {
      const int count = static_cast<int>(colour.size());
#pragma omp for schedule(static)
      for (int n = 0; n < count; ++n) {
        const int cell = colour[n];
        results[cell] = evaluateCell<S>(cell, u, order, scratch);
        if (order != Order::ENERGY && results[cell].finite) scatter<S>(cell, order, scratch, out);
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

template <int D>
void Discretisation<D>::assemble(const Eigen::VectorXd& u, Order order, int threads, Assembly& out) const {
  out.energy = 0;
  out.finite = true;
  out.min_det_f = std::numeric_limits<double>::infinity();
  out.min_det_f_cell = -1;
  if (order != Order::ENERGY) out.gradient.setZero(dofCount());
  if (elasticity::withTangent(order) && !out.add_blocks) {
    out.blocks.assign(static_cast<std::size_t>(pattern_.blocks()) * D * D, 0.0);
  }
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
