// The hot loop: energy, gradient and Hessian of all cells.
#include <algorithm>
#include <cmath>

#include "snapwing/mpm/discretisation.h"

namespace snapwing::mpm {

using elasticity::Order;

/// Cell Hessian as [a][i D + k][b], b <= a contiguous, which is what the compiler turns into SIMD code.
template <int D>
struct Discretisation<D>::Scratch {
  std::vector<double> matrix;
  std::vector<double> force;       ///< [a][i]
  std::vector<double> slope_rows;  ///< grad N_a, by component
  std::vector<double> turned;      ///< Q grad N_a, by component
};

template <int D>
struct Discretisation<D>::CellResult {
  double energy = 0;
  double force_squared = 0;
  double min_det_f = std::numeric_limits<double>::infinity();
  bool finite = true;
};

namespace {

// Wider vectors where the machine has them. Only AVX2 without fused multiply-add: the bits stay the same everywhere.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define SNAPWING_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define SNAPWING_WIDE
#endif

/// K_ab(i,k) += w [(a+a0) d_ik Ga.Gb + b qa_i qb_k + c qb_i qa_k + b0 Ga_i Gb_k + c0 Gb_i Ga_k]
template <int D, int S>
SNAPWING_WIDE void addCompact(const elasticity::CompactTangent<D>& t, double w, const double* g, const double* q,
                              double* matrix) {
  const double diagonal = w * (t.a + t.a0), b = w * t.b, c = w * t.c, b0 = w * t.b0, c0 = w * t.c0;
  const bool linear = t.a0 != 0 || t.b0 != 0;
  for (int a = 0; a < S; ++a) {
    double* rows = matrix + static_cast<std::size_t>(a) * D * D * S;
    double dot[S];
    for (int n = 0; n < S; ++n) dot[n] = 0;
    for (int j = 0; j < D; ++j) {
      const double ga = diagonal * g[j * S + a];
      for (int n = 0; n <= a; ++n) dot[n] += ga * g[j * S + n];
    }
    for (int i = 0; i < D; ++i) {
      for (int k = 0; k < D; ++k) {
        double* row = rows + (i * D + k) * S;
        const double bq = b * q[i * S + a], cq = c * q[k * S + a];
        const double* qk = q + k * S;
        const double* qi = q + i * S;
        for (int n = 0; n <= a; ++n) row[n] += bq * qk[n] + cq * qi[n];
        if (i == k) {
          for (int n = 0; n <= a; ++n) row[n] += dot[n];
        }
        if (linear) {
          const double bg = b0 * g[i * S + a], cg = c0 * g[k * S + a];
          for (int n = 0; n <= a; ++n) row[n] += bg * g[k * S + n] + cg * g[i * S + n];
        }
      }
    }
  }
}

template <int D, int S>
void addFull(const elasticity::FullTangent<D>& t, double w, const double* g, double* matrix) {
  for (int a = 0; a < S; ++a) {
    for (int i = 0; i < D; ++i) {
      for (int k = 0; k < D; ++k) {
        double* row = matrix + (static_cast<std::size_t>(a) * D * D + i * D + k) * S;
        for (int l = 0; l < D; ++l) {
          double factor = 0;
          for (int j = 0; j < D; ++j) factor += g[j * S + a] * t(i + D * j, k + D * l);
          factor *= w;
          for (int n = 0; n <= a; ++n) row[n] += factor * g[l * S + n];
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
  const bool tangent = order == Order::TANGENT || order == Order::PROJECTED;
  if (tangent) std::fill(scratch.matrix.begin(), scratch.matrix.end(), 0.0);
  Eigen::Matrix<double, D, S> force = Eigen::Matrix<double, D, S>::Zero();
  CellResult result;
  elasticity::Response<D> response;
  for (const Term& term : kinds_[cell.kind]) {
    const QuadratureRule<D>& rule = rules_[term.rule];
    const Model& law = *models_[term.model];
    for (int p = 0; p < rule.size(); ++p) {
      const Eigen::Map<const Eigen::Matrix<double, D, S>> slope(rule.slopeOf(p));
      const elasticity::Matrix<D> f = elasticity::Matrix<D>::Identity() + moved * slope.transpose();
      const bool good = law.evaluate(f, cell.density, order, response);
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
      Eigen::Map<Eigen::Matrix<double, S, D>> rows(scratch.slope_rows.data()), turned(scratch.turned.data());
      rows = slope.transpose();
      if (response.compact) {
        turned = slope.transpose() * response.tangent.q.transpose();
        addCompact<D, S>(response.tangent, w, rows.data(), turned.data(), scratch.matrix.data());
      } else {
        addFull<D, S>(response.full, w, rows.data(), scratch.matrix.data());
      }
    }
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
    const double* rows = scratch.matrix.data() + static_cast<std::size_t>(a) * D * D * S;
    for (int b = 0; b <= a; ++b, ++pair) {
      double* block = out.blocks.data() + static_cast<std::size_t>(*pair) * D * D;
      for (int i = 0; i < D; ++i) {
        for (int k = 0; k < D; ++k) block[i + D * k] += rows[(i * D + k) * S + b];
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
    Scratch scratch;
    scratch.matrix.resize(static_cast<std::size_t>(S) * S * D * D);
    scratch.force.resize(S * D);
    scratch.slope_rows.resize(S * D);
    scratch.turned.resize(S * D);
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
  if (order == Order::TANGENT || order == Order::PROJECTED) {
    out.blocks.assign(static_cast<std::size_t>(pattern_.blocks()) * D * D, 0.0);
  }
  constexpr int LINEAR_STENCIL = D == 2 ? 4 : 8, QUADRATIC_STENCIL = D == 2 ? 9 : 27;
  if (stencil_ == LINEAR_STENCIL) {
    assembleCells<LINEAR_STENCIL>(u, order, threads, out);
  } else {
    assembleCells<QUADRATIC_STENCIL>(u, order, threads, out);
  }
  if (!std::isfinite(out.energy)) out.finite = false;
}

template void Discretisation<2>::assemble(const Eigen::VectorXd&, Order, int, Assembly&) const;
template void Discretisation<3>::assemble(const Eigen::VectorXd&, Order, int, Assembly&) const;

}  // namespace snapwing::mpm
