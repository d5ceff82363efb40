#include "snapwing/mpm/moving_mass.h"

#include "snapwing/mpm/mass.h"
#include "stencil.h"

namespace snapwing::mpm {

namespace {

/// What a cell of S nodes adds.
template <int D, int S>
void addCell(double cell_mass, const QuadratureRule<D>& rule, const int* nodes, const Eigen::VectorXd& rate,
             const Vector<D>& axis, MovingMass& sum) {
  Eigen::Matrix<double, D, S> moving;
  for (int a = 0; a < S; ++a) moving.col(a) = rate.segment<D>(D * nodes[a]);
  for (int q = 0; q < rule.size(); ++q) {
    const double* value = rule.valueOf(q);
    Vector<D> moves = Vector<D>::Zero();
    for (int a = 0; a < S; ++a) moves += value[a] * moving.col(a);
    const double mass = cell_mass * rule.weight[q];
    sum.mass += mass;
    sum.kinetic += mass * moves.squaredNorm();
    sum.coupled += mass * axis.dot(moves);
  }
}

}  // namespace

template <int D>
MovingMass movingMass(const Discretisation<D>& solid, const std::vector<double>& mass_density,
                      const Eigen::VectorXd& rate, const Vector<D>& axis, const std::vector<int>& rules) {
  MovingMass sum;
  for (int c = 0; c < solid.cellCount(); ++c) {
    const Cell& cell = solid.cell(c);
    const double cell_mass = mass_density[solid.cellBody(c)] * cell.density * cell.measure;
    const QuadratureRule<D>& rule = massRule(solid, c, rules);
    const auto add =
        rule.stencil == LINEAR_STENCIL<D> ? addCell<D, LINEAR_STENCIL<D>> : addCell<D, QUADRATIC_STENCIL<D>>;
    add(cell_mass, rule, solid.cellNodes(c), rate, axis, sum);
  }
  return sum;
}

template MovingMass movingMass<2>(const Discretisation<2>&, const std::vector<double>&, const Eigen::VectorXd&,
                                  const Vector<2>&, const std::vector<int>&);
template MovingMass movingMass<3>(const Discretisation<3>&, const std::vector<double>&, const Eigen::VectorXd&,
                                  const Vector<3>&, const std::vector<int>&);

}  // namespace snapwing::mpm
