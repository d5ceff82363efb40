#include "snapwing/mpm/moving_mass.h"

namespace snapwing::mpm {

namespace {

/// A cell's material may be integrated in parts, each with the whole volume: the finest rule of them.
template <int D>
const mpm::QuadratureRule<D>& finestRule(const mpm::Discretisation<D>& solid, int kind) {
  const std::vector<mpm::Term>& terms = solid.terms(kind);
  int finest = terms.front().rule;
  for (const mpm::Term& term : terms) {
    if (solid.rule(term.rule).size() > solid.rule(finest).size()) finest = term.rule;
  }
  return solid.rule(finest);
}

}  // namespace

template <int D>
MovingMass movingMass(const mpm::Discretisation<D>& solid, const std::vector<double>& mass_density,
                      const Eigen::VectorXd& rate, const mpm::Vector<D>& axis, const std::vector<int>& rules) {
  MovingMass sum;
  for (int c = 0; c < solid.cellCount(); ++c) {
    const mpm::Cell& cell = solid.cell(c);
    const double cell_mass = mass_density[solid.cellBody(c)] * cell.density * cell.measure;
    const mpm::QuadratureRule<D>& rule = rules.empty() ? finestRule(solid, cell.kind) : solid.rule(rules[c]);
    for (int q = 0; q < rule.size(); ++q) {
      mpm::Vector<D> moves = mpm::Vector<D>::Zero();
      for (int a = 0; a < rule.stencil; ++a) {
        moves += rule.valueOf(q)[a] * rate.segment<D>(D * solid.cellNodes(c)[a]);
      }
      const double mass = cell_mass * rule.weight[q];
      sum.mass += mass;
      sum.kinetic += mass * moves.squaredNorm();
      sum.coupled += mass * axis.dot(moves);
    }
  }
  return sum;
}

template MovingMass movingMass<2>(const mpm::Discretisation<2>&, const std::vector<double>&, const Eigen::VectorXd&,
                                  const mpm::Vector<2>&, const std::vector<int>&);
template MovingMass movingMass<3>(const mpm::Discretisation<3>&, const std::vector<double>&, const Eigen::VectorXd&,
                                  const mpm::Vector<3>&, const std::vector<int>&);

}  // namespace snapwing::mpm
