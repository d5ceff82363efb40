// The hot loop of cells side by side: every loop over lanes is one that the compiler turns into vectors.
#include "assembly_lanes.h"

#include <algorithm>
#include <cmath>

#include "snapwing/common/wide.h"
#include "stencil.h"

namespace snapwing::mpm {

using elasticity::Lanes;
using elasticity::LANES;
using elasticity::Order;

namespace {

/// h = sum_a u_a (grad N_a)^T
template <int D, int S>
SNAPWING_WIDE void strainLanes(const double* __restrict slope, const Lanes* __restrict moved, Lanes* __restrict h) {
#pragma omp simd
  for (int l = 0; l < LANES; ++l) {
    for (int i = 0; i < D; ++i) {
      for (int j = 0; j < D; ++j) {
        double sum = 0;
        for (int a = 0; a < S; ++a) sum += moved[D * a + i].at[l] * slope[D * a + j];
        h[i + D * j].at[l] = sum;
      }
    }
  }
}

/// Energy and least determinant.
template <int D>
SNAPWING_WIDE void addEnergy(const Lanes& __restrict measure, double weight,
                             const elasticity::ResponseLanes<D>& __restrict r, Lanes& __restrict energy,
                             Lanes& __restrict min_det_f) {
#pragma omp simd
  for (int l = 0; l < LANES; ++l) {
    energy.at[l] += measure.at[l] * weight * r.energy.at[l];
    min_det_f.at[l] = r.det_f.at[l] < min_det_f.at[l] ? r.det_f.at[l] : min_det_f.at[l];
  }
}

/// force_a += w P grad N_a
template <int D, int S>
SNAPWING_WIDE void addForce(const double* __restrict slope, const Lanes& __restrict measure, double weight,
                            const elasticity::ResponseLanes<D>& __restrict r, Lanes* __restrict force) {
#pragma omp simd
  for (int l = 0; l < LANES; ++l) {
    const double w = measure.at[l] * weight;
    for (int i = 0; i < D; ++i) {
      for (int a = 0; a < S; ++a) {
        double sum = 0;
        for (int j = 0; j < D; ++j) sum += r.stress[i + D * j].at[l] * slope[D * a + j];
        force[D * a + i].at[l] += w * sum;
      }
    }
  }
}

/// q_a = Q grad N_a, w b q_a and w c q_a.
template <int D, int S>
SNAPWING_WIDE void turnLanes(const double* __restrict slope, const Lanes& __restrict measure, double weight,
                             const elasticity::ResponseLanes<D>& __restrict r, Lanes* __restrict rows) {
#pragma omp simd
  for (int l = 0; l < LANES; ++l) {
    const double b = measure.at[l] * weight * r.b.at[l], c = measure.at[l] * weight * r.c.at[l];
    for (int a = 0; a < S; ++a) {
      for (int i = 0; i < D; ++i) {
        double sum = 0;
        for (int j = 0; j < D; ++j) sum += r.q[i + D * j].at[l] * slope[D * a + j];
        rows[D * a + i].at[l] = sum;
        rows[D * (S + a) + i].at[l] = b * sum;
        rows[D * (2 * S + a) + i].at[l] = c * sum;
      }
    }
  }
}

/// K_ab(i,k) += b qa_i qb_k + c qa_k qb_i
template <int D, int S>
SNAPWING_WIDE void addTurned(const Lanes* __restrict rows, Lanes* __restrict matrix) {
  for (int a = 0; a < S; ++a) {
    for (int b = 0; b <= a; ++b) {
      const Lanes *with_b = rows + D * (S + a), *with_c = rows + D * (2 * S + a), *q = rows + D * b;
#pragma omp simd
      for (int l = 0; l < LANES; ++l) {
        for (int i = 0; i < D; ++i) {
          for (int k = 0; k < D; ++k) {
            matrix[i * D + k].at[l] += with_b[i].at[l] * q[k].at[l] + with_c[k].at[l] * q[i].at[l];
          }
        }
      }
      matrix += D * D;
    }
  }
}

/// K_ab(i,k) += diagonal d_ik L_ab, and b T_ab(i,k) + c T_ab(k,i) if there is such a part
template <int D, int S>
SNAPWING_WIDE void addTables(const Lanes& __restrict diagonal, const Lanes& __restrict b, const Lanes& __restrict c,
                             const double* __restrict laplace, const double* __restrict outer,
                             Lanes* __restrict matrix) {
  constexpr int ROW = paddedStencil(S);
  for (int a = 0; a < S; ++a) {
    for (int n = 0; n <= a; ++n, matrix += D * D) {
      for (int i = 0; i < D; ++i) {
        for (int k = 0; k < D; ++k) {
          const double same = outer != nullptr ? outer[((a * D + i) * D + k) * ROW + n] : 0;
          const double swapped = outer != nullptr ? outer[((a * D + k) * D + i) * ROW + n] : 0;
          const double on_diagonal = i == k ? laplace[a * ROW + n] : 0;
#pragma omp simd
          for (int l = 0; l < LANES; ++l) {
            matrix[i * D + k].at[l] += diagonal.at[l] * on_diagonal + (b.at[l] * same + c.at[l] * swapped);
          }
        }
      }
    }
  }
}

bool nothing(const Lanes& lanes) {
  return std::all_of(lanes.at, lanes.at + LANES, [](double value) { return value == 0; });
}

}  // namespace

template <int D>
bool Discretisation<D>::inLanes(int kind, Order order) const {
  const std::vector<Term>& terms = kinds_[kind];
  return std::all_of(terms.begin(), terms.end(), [&](const Term& t) { return models_[t.model]->inLanes(order); });
}

template <int D>
template <int S>
void Discretisation<D>::addShared(const Batch& batch, int term, LaneScratch& scratch) const {
  const Term& t = kinds_[cells_[batch.cells[0]].kind][term];
  Lanes a, b, c;
  for (int l = 0; l < LANES; ++l) {
    const std::size_t state = static_cast<std::size_t>(batch.cells[l]) * most_terms_ + term;
    const elasticity::SharedTangent shared = models_[t.model]->shared(prepared_[state], Order::TANGENT);
    a.at[l] = scratch.measure.at[l] * shared.a;
    b.at[l] = scratch.measure.at[l] * shared.b;
    c.at[l] = scratch.measure.at[l] * shared.c;
  }
  if (nothing(a) && nothing(b) && nothing(c)) return;
  const RuleTable& table = tables_[t.rule];
  const double* outer = nothing(b) && nothing(c) ? nullptr : table.outer.data();
  addTables<D, S>(a, b, c, table.laplace.data(), outer, scratch.matrix.data());
}

template <int D>
template <int S>
void Discretisation<D>::evaluateBatch(const Batch& batch, const Eigen::VectorXd& u, Order order, LaneScratch& scratch,
                                      CellResult* results) const {
  LaneScratch& s = scratch;
  const bool tangent = elasticity::withTangent(order);
  for (int l = 0; l < LANES; ++l) {
    const int* nodes = cellNodes(batch.cells[l]);
    for (int a = 0; a < S; ++a) {
      for (int i = 0; i < D; ++i) s.moved[D * a + i].at[l] = u(D * nodes[a] + i);
    }
    s.measure.at[l] = cells_[batch.cells[l]].measure;
    s.energy.at[l] = 0;
    s.min_det_f.at[l] = std::numeric_limits<double>::infinity();
  }
  std::fill(s.force.begin(), s.force.end(), Lanes{});
  if (tangent) std::fill(s.matrix.begin(), s.matrix.end(), Lanes{});
  const std::vector<Term>& terms = kinds_[cells_[batch.cells[0]].kind];
  for (int t = 0; t < static_cast<int>(terms.size()); ++t) {
    const QuadratureRule<D>& rule = rules_[terms[t].rule];
    for (int l = 0; l < LANES; ++l) {
      const auto& state = prepared_[static_cast<std::size_t>(batch.cells[l]) * most_terms_ + t];
      s.points.stiffness.at[l] = state.stiffness;
      s.points.mix.at[l] = state.mix;
    }
    for (int p = 0; p < rule.size(); ++p) {
      const double *slope = rule.slopeOf(p), weight = rule.weight[p];
      strainLanes<D, S>(slope, s.moved.data(), s.points.h);
      models_[terms[t].model]->evaluateLanes(s.points, s.response);
      addEnergy<D>(s.measure, weight, s.response, s.energy, s.min_det_f);
      if (order == Order::ENERGY) continue;
      addForce<D, S>(slope, s.measure, weight, s.response, s.force.data());
      if (!tangent || (nothing(s.response.b) && nothing(s.response.c))) continue;
      turnLanes<D, S>(slope, s.measure, weight, s.response, s.rows.data());
      addTurned<D, S>(s.rows.data(), s.matrix.data());
    }
    if (tangent) addShared<S>(batch, t, s);
  }
  for (int l = 0; l < batch.count; ++l) {
    CellResult& r = results[batch.cells[l]];
    r.energy = s.energy.at[l];
    r.min_det_f = s.min_det_f.at[l];
    r.finite = std::isfinite(r.energy);
    r.force_squared = 0;
    for (const Lanes& component : s.force) r.force_squared += component.at[l] * component.at[l];
  }
}

template <int D>
template <int S>
void Discretisation<D>::scatterBatch(const Batch& batch, Order order, const LaneScratch& scratch,
                                     const CellResult* results, Assembly& out) const {
  for (int l = 0; l < batch.count; ++l) {
    const int number = batch.cells[l];
    if (!results[number].finite) continue;
    const int* nodes = cellNodes(number);
    for (int a = 0; a < S; ++a) {
      for (int i = 0; i < D; ++i) out.gradient(D * nodes[a] + i) += scratch.force[D * a + i].at[l];
    }
    if (order == Order::STRESS) continue;
    constexpr int PAIRS = S * (S + 1) / 2;
    const int* pair = block_of_pair_.data() + static_cast<std::size_t>(number) * PAIRS;
    const Lanes* entry = scratch.matrix.data();
    for (int n = 0; n < PAIRS; ++n, entry += D * D) {
      double* block = out.blocks.data() + static_cast<std::size_t>(pair[n]) * D * D;
      for (int i = 0; i < D; ++i) {
        for (int k = 0; k < D; ++k) block[i + D * k] += entry[i * D + k].at[l];
      }
    }
  }
}

template bool Discretisation<2>::inLanes(int, Order) const;
template bool Discretisation<3>::inLanes(int, Order) const;

#define SNAPWING_BATCHES(D, S)                                                                                 \
  template void Discretisation<D>::evaluateBatch<S>(const Batch&, const Eigen::VectorXd&, Order, LaneScratch&, \
                                                    CellResult*) const;                                        \
  template void Discretisation<D>::scatterBatch<S>(const Batch&, Order, const LaneScratch&, const CellResult*, \
                                                   Assembly&) const;
SNAPWING_BATCHES(2, LINEAR_STENCIL<2>)
SNAPWING_BATCHES(2, QUADRATIC_STENCIL<2>)
SNAPWING_BATCHES(3, LINEAR_STENCIL<3>)
SNAPWING_BATCHES(3, QUADRATIC_STENCIL<3>)
#undef SNAPWING_BATCHES

}  // namespace snapwing::mpm
