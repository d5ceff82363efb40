// Derivatives of energy and forces by the cells' densities: the hot loop of the adjoint.
#include "snapwing/mpm/discretisation.h"
#include "stencil.h"

namespace snapwing::mpm {

/// S = nodes of a cell, so that the loops over them have a fixed length.
template <int D>
template <int S>
double Discretisation<D>::cellDensityDerivative(int number, const Eigen::VectorXd& u, const Eigen::VectorXd& v) const {
  const Cell& cell = cells_[number];
  const int* nodes = cellNodes(number);
  Eigen::Matrix<double, D, S> moved, direction;
  for (int a = 0; a < S; ++a) moved.col(a) = u.template segment<D>(D * nodes[a]);
  const bool along = v.size() > 0;
  if (along) {
    for (int a = 0; a < S; ++a) direction.col(a) = v.template segment<D>(D * nodes[a]);
  }
  double sum = 0;
  const std::vector<Term>& terms = kinds_[cell.kind];
  for (std::size_t t = 0; t < terms.size(); ++t) {
    const QuadratureRule<D>& rule = rules_[terms[t].rule];
    const Model& law = *models_[terms[t].model];
    const auto& state = prepared_[static_cast<std::size_t>(number) * most_terms_ + t];
    for (int p = 0; p < rule.size(); ++p) {
      const Eigen::Map<const Eigen::Matrix<double, D, S>> slope(rule.slopeOf(p));
      const elasticity::Matrix<D> f = elasticity::Matrix<D>::Identity() + moved * slope.transpose();
      double d_energy = 0;
      elasticity::Matrix<D> d_stress;
      if (!law.densityDerivative(f, state, d_energy, d_stress)) continue;
      if (along) d_energy = d_stress.cwiseProduct(direction * slope.transpose()).sum();
      sum += cell.measure * rule.weight[p] * d_energy;
    }
  }
  return sum;
}

template <int D>
Eigen::VectorXd Discretisation<D>::densityDerivative(const Eigen::VectorXd& u, const Eigen::VectorXd& v) const {
  Eigen::VectorXd result(cellCount());
  for (int c = 0; c < cellCount(); ++c) {
    result(c) = stencil_ == LINEAR_STENCIL<D> ? cellDensityDerivative<LINEAR_STENCIL<D>>(c, u, v)
                                              : cellDensityDerivative<QUADRATIC_STENCIL<D>>(c, u, v);
  }
  return result;
}

template Eigen::VectorXd Discretisation<2>::densityDerivative(const Eigen::VectorXd&, const Eigen::VectorXd&) const;
template Eigen::VectorXd Discretisation<3>::densityDerivative(const Eigen::VectorXd&, const Eigen::VectorXd&) const;

}  // namespace snapwing::mpm
