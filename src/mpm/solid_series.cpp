#include "snapwing/mpm/solid_series.h"

#include <algorithm>
#include <cstddef>
#include <map>

#include "snapwing/common/wide.h"

namespace snapwing::mpm {

using elasticity::Lanes;
using elasticity::LANES;
using elasticity::TaylorTape;

template <int D>
struct SolidSeries<D>::Batch {
  int kind;
  int cells[LANES];  ///< the last one fills what is left, with no weight
  int count;
  std::size_t first;         ///< of its states
  std::vector<Lanes> mix;    ///< of each term
  std::vector<Lanes> scale;  ///< of each term: measure, stiffness and mix
};

template <int D>
struct SolidSeries<D>::Scratch {
  Scratch(int stencil, int nodes) : moved(D * stencil), force(D * stencil), stress(D * D), change(nodes) {}
  std::vector<Lanes> moved, force;  ///< [a][i]
  std::vector<Lanes> stress;        ///< by columns
  std::vector<Lanes> change;        ///< of a tape's nodes; first those of F
};

namespace {

/// F_k = mix sum_a u_a (grad N_a)^T, and I where k = 0, by columns.
template <int D>
SNAPWING_WIDE void gradient(int stencil, const double* __restrict slope, const Lanes& __restrict mix, double identity,
                            const Lanes* __restrict moved, Lanes* __restrict f) {
  for (int i = 0; i < D; ++i) {
    for (int j = 0; j < D; ++j) {
      Lanes sum{};
      for (int a = 0; a < stencil; ++a) {
#pragma omp simd
        for (int l = 0; l < LANES; ++l) sum.at[l] += moved[D * a + i].at[l] * slope[D * a + j];
      }
      const double one = i == j ? identity : 0;
#pragma omp simd
      for (int l = 0; l < LANES; ++l) f[i + D * j].at[l] = one + mix.at[l] * sum.at[l];
    }
  }
}

/// force_a += w scale P grad N_a
template <int D>
SNAPWING_WIDE void addForce(int stencil, const double* __restrict slope, double weight, const Lanes& __restrict scale,
                            const Lanes* __restrict stress, Lanes* __restrict force) {
  for (int a = 0; a < stencil; ++a) {
    for (int i = 0; i < D; ++i) {
      Lanes sum{};
      for (int j = 0; j < D; ++j) {
#pragma omp simd
        for (int l = 0; l < LANES; ++l) sum.at[l] += stress[i + D * j].at[l] * slope[D * a + j];
      }
#pragma omp simd
      for (int l = 0; l < LANES; ++l) force[D * a + i].at[l] += weight * scale.at[l] * sum.at[l];
    }
  }
}

/// Tape of each law that some cell has; others are empty.
template <int D>
std::map<int, TaylorTape> tapesOf(const Discretisation<D>& solid) {
  std::map<int, TaylorTape> tapes;
  for (int c = 0; c < solid.cellCount(); ++c) {
    for (const Term& term : solid.terms(solid.cell(c).kind)) {
      const auto [tape, added] = tapes.emplace(term.model, TaylorTape(D * D));
      if (added) solid.model(term.model).writeStress(tape->second);
    }
  }
  return tapes;
}

/// A cell whose terms are all linear adds nothing beyond K u_k.
template <int D>
bool linear(const Discretisation<D>& solid, const Cell& cell) {
  const std::vector<Term>& terms = solid.terms(cell.kind);
  return std::all_of(terms.begin(), terms.end(), [&](const Term& term) {
    const auto& law = solid.model(term.model);
    return law.linear(law.prepare(cell.density));
  });
}

}  // namespace

template <int D>
bool SolidSeries<D>::possible(const Discretisation<D>& solid) {
  const auto tapes = tapesOf(solid);
  return std::none_of(tapes.begin(), tapes.end(), [](const auto& entry) { return entry.second.empty(); });
}

template <int D>
SolidSeries<D>::SolidSeries(const Discretisation<D>& solid, int order) : solid_(solid), order_(order) {
  const auto tapes = tapesOf(solid);
  for (const auto& [model, tape] : tapes) {
    tapes_.resize(model + 1, TaylorTape(D * D));
    tapes_[model] = tape;
  }
  std::map<int, std::vector<int>> by_kind;
  for (int c = 0; c < solid.cellCount(); ++c) {
    if (!linear(solid, solid.cell(c))) by_kind[solid.cell(c).kind].push_back(c);
  }
  for (const auto& [kind, cells] : by_kind) addBatches(cells);
}

template <int D>
SolidSeries<D>::~SolidSeries() = default;

template <int D>
void SolidSeries<D>::addBatches(const std::vector<int>& cells) {
  const int kind = solid_.cell(cells.front()).kind;
  const std::vector<Term>& terms = solid_.terms(kind);
  std::size_t room = 0;
  for (const Term& term : terms) {
    room += static_cast<std::size_t>(solid_.rule(term.rule).size()) * tapes_[term.model].room(order_);
  }
  for (std::size_t first = 0; first < cells.size(); first += LANES) {
    Batch batch{kind, {}, static_cast<int>(std::min<std::size_t>(LANES, cells.size() - first)), size_, {}, {}};
    batch.mix.resize(terms.size());
    batch.scale.resize(terms.size());
    for (int l = 0; l < LANES; ++l) {
      const int number = batch.cells[l] = cells[first + std::min(l, batch.count - 1)];
      const Cell& cell = solid_.cell(number);
      for (std::size_t t = 0; t < terms.size(); ++t) {
        const auto value = solid_.model(terms[t].model).prepare(cell.density);
        batch.mix[t].at[l] = value.mix;
        batch.scale[t].at[l] = l < batch.count ? cell.measure * value.stiffness * value.mix : 0;
      }
    }
    size_ += room;
    batches_.push_back(std::move(batch));
  }
}

template <int D>
double SolidSeries<D>::bytes() const {
  return static_cast<double>(size_) * sizeof(Lanes);
}

template <int D>
void SolidSeries<D>::gather(const Batch& batch, const Eigen::VectorXd& u, Scratch& scratch) const {
  for (int l = 0; l < LANES; ++l) {
    const int* nodes = solid_.cellNodes(batch.cells[l]);
    for (int a = 0; a < solid_.stencil(); ++a) {
      for (int i = 0; i < D; ++i) scratch.moved[D * a + i].at[l] = u(D * nodes[a] + i);
    }
  }
}

template <int D>
void SolidSeries<D>::start(const Eigen::VectorXd& u) {
  // Not set to zero: a series that ends early leaves most pages untouched.
  if (states_ == nullptr) states_.reset(new Lanes[size_]);
  Scratch scratch(solid_.stencil(), 0);
  for (const Batch& batch : batches_) {
    gather(batch, u, scratch);
    Lanes* state = states_.get() + batch.first;
    const std::vector<Term>& terms = solid_.terms(batch.kind);
    for (std::size_t t = 0; t < terms.size(); ++t) {
      const TaylorTape& tape = tapes_[terms[t].model];
      const QuadratureRule<D>& rule = solid_.rule(terms[t].rule);
      for (int p = 0; p < rule.size(); ++p, state += tape.room(order_)) {
        gradient<D>(solid_.stencil(), rule.slopeOf(p), batch.mix[t], 1, scratch.moved.data(), tape.inputsOf(state));
        tape.start(state, scratch.stress.data());
      }
    }
  }
}

template <int D>
void SolidSeries<D>::advance(int k, const Eigen::VectorXd& u, Eigen::VectorXd& force) {
  int most_nodes = 0;
  for (const TaylorTape& tape : tapes_) most_nodes = std::max(most_nodes, tape.nodes());
  Scratch scratch(solid_.stencil(), most_nodes);
  for (const Batch& batch : batches_) {
    gather(batch, u, scratch);
    std::fill(scratch.force.begin(), scratch.force.end(), Lanes{});
    Lanes* state = states_.get() + batch.first;
    const std::vector<Term>& terms = solid_.terms(batch.kind);
    for (std::size_t t = 0; t < terms.size(); ++t) {
      const TaylorTape& tape = tapes_[terms[t].model];
      const QuadratureRule<D>& rule = solid_.rule(terms[t].rule);
      for (int p = 0; p < rule.size(); ++p, state += tape.room(order_)) {
        gradient<D>(solid_.stencil(), rule.slopeOf(p), batch.mix[t], 0, scratch.moved.data(), scratch.change.data());
        if (k == 1) tape.remainder(1, state, scratch.stress.data());  // zeros, and what depends on no argument
        tape.complete(k, state, scratch.change.data());
        tape.remainder(k + 1, state, scratch.stress.data());
        addForce<D>(solid_.stencil(), rule.slopeOf(p), rule.weight[p], batch.scale[t], scratch.stress.data(),
                    scratch.force.data());
      }
    }
    for (int l = 0; l < batch.count; ++l) {
      const int* nodes = solid_.cellNodes(batch.cells[l]);
      for (int a = 0; a < solid_.stencil(); ++a) {
        for (int i = 0; i < D; ++i) force(D * nodes[a] + i) += scratch.force[D * a + i].at[l];
      }
    }
  }
}

template class SolidSeries<2>;
template class SolidSeries<3>;

}  // namespace snapwing::mpm
