#pragma once
/// Deformation gradients at the centres of cells (private to the layer).

#include "snapwing/mpm/discretisation.h"

namespace snapwing::mpm {

/// Deformation gradient where the basis functions have these slopes, one a column.
template <int D>
elasticity::Matrix<D> gradientBy(const Discretisation<D>& solid, const Eigen::Matrix<double, D, Eigen::Dynamic>& slope,
                                 int cell, const Eigen::VectorXd& u) {
  elasticity::Matrix<D> f = elasticity::Matrix<D>::Identity();
  for (int a = 0; a < solid.stencil(); ++a) {
    f += u.template segment<D>(D * solid.cellNodes(cell)[a]) * slope.col(a).transpose();
  }
  return f;
}

/// Calls visit(cell, F) for each cell. The slopes at a centre are those of the body's grid.
template <int D, class Visit>
void eachCentreGradient(const Discretisation<D>& solid, const Eigen::VectorXd& u, const Visit& visit) {
  Eigen::VectorXd value;
  Eigen::Matrix<double, D, Eigen::Dynamic> slope;
  int body = -1;
  for (int cell = 0; cell < solid.cellCount(); ++cell) {
    if (solid.cellBody(cell) != body) {
      body = solid.cellBody(cell);
      solid.grid(body).weights(Vector<D>::Constant(0.5), value, slope);
    }
    visit(cell, gradientBy<D>(solid, slope, cell, u));
  }
}

}  // namespace snapwing::mpm
