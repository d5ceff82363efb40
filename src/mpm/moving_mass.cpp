#include "snapwing/mpm/moving_mass.h"

#include "snapwing/mpm/mass.h"

namespace snapwing::mpm {

template <int D>
MovingMass movingMass(const Discretisation<D>& solid, const std::vector<double>& mass_density,
                      const Eigen::VectorXd& rate, const Vector<D>& axis, const std::vector<int>& rules) {
  MovingMass sum;
  for (int c = 0; c < solid.cellCount(); ++c) {
    const Cell& cell = solid.cell(c);
    const double cell_mass = mass_density[solid.cellBody(c)] * cell.density * cell.measure;
    const QuadratureRule<D>& rule = massRule(solid, c, rules);
    for (int q = 0; q < rule.size(); ++q) {
      Vector<D> moves = Vector<D>::Zero();
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

template MovingMass movingMass<2>(const Discretisation<2>&, const std::vector<double>&, const Eigen::VectorXd&,
                                  const Vector<2>&, const std::vector<int>&);
template MovingMass movingMass<3>(const Discretisation<3>&, const std::vector<double>&, const Eigen::VectorXd&,
                                  const Vector<3>&, const std::vector<int>&);

}  // namespace snapwing::mpm
