#include "snapwing/mpm/discretisation.h"

#include <algorithm>
#include <cmath>

#include "centre_gradients.h"
#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"

namespace snapwing::mpm {

template <int D>
int Discretisation<D>::addModel(std::shared_ptr<const Model> model) {
  models_.push_back(std::move(model));
  return static_cast<int>(models_.size()) - 1;
}

template <int D>
int Discretisation<D>::addRule(QuadratureRule<D> rule) {
  if (stencil_ != 0 && rule.stencil != stencil_) throw common::Error("all bodies must use the same kernel");
  stencil_ = rule.stencil;
  rules_.push_back(std::move(rule));
  return static_cast<int>(rules_.size()) - 1;
}

template <int D>
int Discretisation<D>::addKind(std::vector<Term> terms) {
  kinds_.push_back(std::move(terms));
  return static_cast<int>(kinds_.size()) - 1;
}

template <int D>
int Discretisation<D>::addBody(const Grid<D>& grid) {
  for (int a = 0; a < D; ++a) {
    if (grid.cells[a] < 1) throw common::Error("grid has no cells along axis " + std::to_string(a));
  }
  grids_.push_back(grid);
  node_of_grid_.emplace_back(grid.nodeCount(), -1);
  cell_of_grid_.emplace_back(grid.cellCount(), -1);
  return bodyCount() - 1;
}

template <int D>
int Discretisation<D>::addCell(const Index<D>& at, const Cell& cell) {
  const int body = bodyCount() - 1;
  const int number = cellCount();
  cell_of_grid_[body][grids_[body].cellNumber(at)] = number;
  cells_.push_back(cell);
  cell_at_.push_back(at);
  cell_body_.push_back(body);
  return number;
}

template <int D>
void Discretisation<D>::finish() {
  if (cells_.empty()) throw common::Error("no cell holds material: body and grid do not overlap");
  numberNodes();
  pattern_ = BlockPattern<D>(nodeCount(), nodes_, stencil_);
  block_of_pair_.reserve(cells_.size() * static_cast<std::size_t>(stencil_ * (stencil_ + 1) / 2));
  for (int c = 0; c < cellCount(); ++c) {
    const int* nodes = cellNodes(c);
    for (int a = 0; a < stencil_; ++a) {
      for (int b = 0; b <= a; ++b) block_of_pair_.push_back(pattern_.find(nodes[a], nodes[b]));
    }
  }
  colourCells();
  prepareCells();
}

constexpr elasticity::Order TANGENTS[] = {elasticity::Order::TANGENT, elasticity::Order::PROJECTED,
                                          elasticity::Order::ABSOLUTE};

/// What does not change with the displacements: the law's state per cell, and sums over the particles of each rule.
template <int D>
void Discretisation<D>::prepareCells() {
  for (const std::vector<Term>& terms : kinds_) most_terms_ = std::max(most_terms_, static_cast<int>(terms.size()));
  prepared_.resize(cells_.size() * most_terms_);
  tables_.resize(rules_.size());
  for (int c = 0; c < cellCount(); ++c) {
    const std::vector<Term>& terms = kinds_[cells_[c].kind];
    for (std::size_t t = 0; t < terms.size(); ++t) {
      const Model& law = *models_[terms[t].model];
      const auto value = law.prepare(cells_[c].density);
      prepared_[static_cast<std::size_t>(c) * most_terms_ + t] = value;
      bool outer = false;
      for (const elasticity::Order order : TANGENTS) {
        const elasticity::SharedTangent shared = law.shared(value, order);
        outer = outer || shared.b != 0 || shared.c != 0;
      }
      buildTable(terms[t].rule, outer);
    }
  }
  prepareLinearCells();
  dealCells();
}

template <int D>
void Discretisation<D>::buildTable(int number, bool outer) {
  RuleTable& table = tables_[number];
  const QuadratureRule<D>& rule = rules_[number];
  const int s = stencil_, row = paddedStencil(stencil_);
  const auto sum = [&](int a, int b, int i, int k) {
    double total = 0;
    for (int p = 0; p < rule.size(); ++p)
      total += rule.weight[p] * rule.slopeOf(p)[D * a + i] * rule.slopeOf(p)[D * b + k];
    return total;
  };
  if (table.laplace.empty()) {
    table.laplace.assign(static_cast<std::size_t>(s) * row, 0.0);
    for (int a = 0; a < s; ++a) {
      for (int b = 0; b <= a; ++b) {
        for (int i = 0; i < D; ++i) table.laplace[a * row + b] += sum(a, b, i, i);
      }
    }
  }
  if (!outer || !table.outer.empty()) return;
  table.outer.assign(static_cast<std::size_t>(s) * D * D * row, 0.0);
  for (int a = 0; a < s; ++a) {
    for (int i = 0; i < D; ++i) {
      for (int k = 0; k < D; ++k) {
        for (int b = 0; b <= a; ++b) table.outer[((a * D + i) * D + k) * row + b] = sum(a, b, i, k);
      }
    }
  }
}

/// Numbers nodes in grid order, so that a cell's nodes ascend and local pairs a >= b lie in the lower triangle.
template <int D>
void Discretisation<D>::numberNodes() {
  for (int c = 0; c < cellCount(); ++c) {
    for (const int node : grids_[cell_body_[c]].cellNodes(cell_at_[c])) node_of_grid_[cell_body_[c]][node] = 0;
  }
  for (int body = 0; body < bodyCount(); ++body) {
    for (int node = 0; node < static_cast<int>(node_of_grid_[body].size()); ++node) {
      if (node_of_grid_[body][node] < 0) continue;
      node_of_grid_[body][node] = nodeCount();
      position_.push_back(grids_[body].nodePosition(node));
      node_body_.push_back(body);
    }
  }
  for (int c = 0; c < cellCount(); ++c) {
    const int body = cell_body_[c];
    for (const int node : grids_[body].cellNodes(cell_at_[c])) nodes_.push_back(node_of_grid_[body][node]);
  }
}

template <int D>
void Discretisation<D>::colourCells() {
  const int period = nodesPerAxis(grids_[0].kernel);
  int count = 1;
  for (int a = 0; a < D; ++a) count *= period;
  colours_.assign(count, {});
  for (int c = 0; c < cellCount(); ++c) {
    int colour = 0;
    for (int a = D - 1; a >= 0; --a) colour = colour * period + cell_at_[c][a] % period;
    colours_[colour].push_back(c);
  }
  for (std::vector<int>& cells : colours_) {
    std::stable_sort(cells.begin(), cells.end(), [&](int a, int b) { return cells_[a].kind < cells_[b].kind; });
  }
}

template <int D>
void Discretisation<D>::dealCells() {
  batches_.clear();
  for (const std::vector<int>& cells : colours_) batches_.push_back(dealColour(cells));
}

/// A cell's own numbers do not depend on the others of its batch.
template <int D>
std::vector<typename Discretisation<D>::Batch> Discretisation<D>::dealColour(const std::vector<int>& cells) const {
  std::vector<Batch> batches;
  int open[2] = {-1, -1};  // batch that is not full, of linear cells and of others
  for (const int c : cells) {
    const bool linear = linearCell(c);
    const int last = open[linear];
    const bool fits =
        last >= 0 && batches[last].count < elasticity::LANES && cells_[batches[last].cells[0]].kind == cells_[c].kind;
    if (!fits) {
      open[linear] = static_cast<int>(batches.size());
      batches.push_back({{}, 0, linear});
    }
    Batch& batch = batches[open[linear]];
    std::fill(batch.cells + batch.count++, batch.cells + elasticity::LANES, c);
  }
  return batches;
}

template <int D>
void Discretisation<D>::setDensities(const std::vector<double>& densities) {
  if (densities.size() != cells_.size()) {
    throw common::Error("densities: " + std::to_string(densities.size()) + " values for " +
                        std::to_string(cells_.size()) + " cells");
  }
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    if (!(densities[c] >= 0 && densities[c] <= 1)) {
      throw common::Error("density of cell " + std::to_string(c) + " is " + common::toText(densities[c]) +
                          "; allowed: 0 .. 1");
    }
    cells_[c].density = densities[c];
  }
  prepareCells();
}

template <int D>
int Discretisation<D>::findCell(int body, const Index<D>& at) const {
  for (int a = 0; a < D; ++a) {
    if (at[a] < 0 || at[a] >= grids_[body].cells[a]) return -1;
  }
  return cell_of_grid_[body][grids_[body].cellNumber(at)];
}

template <int D>
std::vector<std::pair<int, double>> Discretisation<D>::interpolate(int body, const Vector<D>& point) const {
  const Grid<D>& grid = grids_[body];
  Index<D> at{};
  Vector<D> local;
  if (!grid.locate(point, at, local)) return {};
  int cell = findCell(body, at);
  // A point on a face belongs to either side: take the neighbour if only that one holds material.
  for (int trial = 0; cell < 0 && trial < (1 << D); ++trial) {
    Index<D> shifted = at;
    Vector<D> moved = local;
    bool possible = true;
    for (int a = 0; a < D; ++a) {
      if (!(trial >> a & 1)) continue;
      if (local(a) < 1e-6) {
        --shifted[a], moved(a) = 1;
      } else if (local(a) > 1 - 1e-6) {
        ++shifted[a], moved(a) = 0;
      } else {
        possible = false;
      }
    }
    if (possible && (cell = findCell(body, shifted)) >= 0) local = moved;
  }
  if (cell < 0) return {};
  Eigen::VectorXd value;
  Eigen::Matrix<double, D, Eigen::Dynamic> slope;
  grid.weights(local, value, slope);
  std::vector<std::pair<int, double>> result;
  for (int a = 0; a < stencil_; ++a) {
    if (std::abs(value(a)) > 1e-12) result.emplace_back(cellNodes(cell)[a], value(a));
  }
  return result;
}

template <int D>
Vector<D> Discretisation<D>::displacementAt(int body, const Vector<D>& point, const Eigen::VectorXd& u) const {
  Vector<D> result = Vector<D>::Zero();
  for (const auto& [node, weight] : interpolate(body, point)) result += weight * u.template segment<D>(D * node);
  return result;
}

template <int D>
elasticity::Matrix<D> Discretisation<D>::deformationGradient(int cell, const Eigen::VectorXd& u) const {
  Eigen::VectorXd value;
  Eigen::Matrix<double, D, Eigen::Dynamic> slope;
  grids_[cell_body_[cell]].weights(Vector<D>::Constant(0.5), value, slope);
  return gradientBy<D>(*this, slope, cell, u);
}

template class Discretisation<2>;
template class Discretisation<3>;

}  // namespace snapwing::mpm
