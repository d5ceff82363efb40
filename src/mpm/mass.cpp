#include "snapwing/mpm/mass.h"

namespace snapwing::mpm {

/// A cell's material may be integrated in parts, each with the whole volume: the finest rule of them.
template <int D>
const QuadratureRule<D>& massRule(const Discretisation<D>& solid, int cell, const std::vector<int>& rules) {
  if (!rules.empty()) return solid.rule(rules[cell]);
  const std::vector<Term>& terms = solid.terms(solid.cell(cell).kind);
  int finest = terms.front().rule;
  for (const Term& term : terms) {
    if (solid.rule(term.rule).size() > solid.rule(finest).size()) finest = term.rule;
  }
  return solid.rule(finest);
}

template <int D>
Mass<D>::Mass(const Discretisation<D>& solid, const std::vector<double>& mass_density, const std::vector<int>& rules,
              MassKind kind)
    : pattern_(solid.pattern()), blocks_(solid.pattern().blocks(), 0.0) {
  for (int node = 0; node < solid.nodeCount(); ++node) rest_.push_back(solid.position(node));
  for (int c = 0; c < solid.cellCount(); ++c) {
    const Cell& cell = solid.cell(c);
    const double cell_mass = mass_density[solid.cellBody(c)] * cell.density * cell.measure;
    const QuadratureRule<D>& rule = massRule(solid, c, rules);
    const int* nodes = solid.cellNodes(c);
    for (int a = 0; a < rule.stencil; ++a) {
      for (int b = 0; b < rule.stencil; ++b) {
        if (nodes[a] < nodes[b]) continue;
        double mass = 0;
        for (int q = 0; q < rule.size(); ++q) mass += rule.weight[q] * rule.valueOf(q)[a] * rule.valueOf(q)[b];
        mass *= cell_mass;
        if (kind == MassKind::CONSISTENT) {
          blocks_[pattern_.find(nodes[a], nodes[b])] += mass;
          continue;
        }
        blocks_[pattern_.find(nodes[a], nodes[a])] += mass;
        if (a != b) blocks_[pattern_.find(nodes[b], nodes[b])] += mass;
      }
    }
  }
}

template <int D>
template <class Visit>
void Mass<D>::eachPair(const Visit& visit) const {
  for (int column = 0; column < pattern_.nodes(); ++column) {
    for (int k = pattern_.start()[column]; k < pattern_.start()[column + 1]; ++k) {
      visit(pattern_.row()[k], column, blocks_[k]);
    }
  }
}

template <int D>
Eigen::VectorXd Mass<D>::multiply(const Eigen::Ref<const Eigen::VectorXd>& v) const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(D * pattern_.nodes());
  eachPair([&](int row, int column, double mass) {
    result.template segment<D>(D * row) += mass * v.template segment<D>(D * column);
    if (row != column) result.template segment<D>(D * column) += mass * v.template segment<D>(D * row);
  });
  return result;
}

template <int D>
MassMoments<D> Mass<D>::moments(const Eigen::VectorXd& u) const {
  MassMoments<D> sum;
  const auto at = [&](int node) { return Vector<D>(rest_[node] + u.template segment<D>(D * node)); };
  eachPair([&](int row, int column, double mass) {
    sum.total += row == column ? mass : 2 * mass;
    sum.centre += mass * (row == column ? at(row) : Vector<D>(at(row) + at(column)));
  });
  if (!(sum.total > 0)) return sum;
  sum.centre /= sum.total;
  eachPair([&](int row, int column, double mass) {
    const Vector<D> a = at(row) - sum.centre, b = at(column) - sum.centre;
    sum.second += mass * (a * b.transpose());
    if (row != column) sum.second += mass * (b * a.transpose());
  });
  return sum;
}

template class Mass<2>;
template class Mass<3>;
template const QuadratureRule<2>& massRule<2>(const Discretisation<2>&, int, const std::vector<int>&);
template const QuadratureRule<3>& massRule<3>(const Discretisation<3>&, int, const std::vector<int>&);

}  // namespace snapwing::mpm
