#include "snapwing/mpm/map_derivative.h"

#include <Eigen/LU>
#include <string>

#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"

namespace snapwing::mpm {

using elasticity::Matrix;

template <int D>
void mapRule(const Matrix<D>& map, QuadratureRule<D>* rule) {
  if (!(map.determinant() > 0)) {
    throw common::Error("map of a body: determinant is " + common::toText(map.determinant()) + "; allowed: above 0");
  }
  const Matrix<D> turned = map.inverse().transpose();
  Eigen::Map<Eigen::Matrix<double, D, Eigen::Dynamic>> slope(rule->slope.data(), D,
                                                             static_cast<int>(rule->slope.size()) / D);
  slope = (turned * slope).eval();
}

namespace {

/// One particle's share; `moved` are the cell's nodal displacements.
template <int D>
void addParticle(const elasticity::SharedTangent& shared, const elasticity::Response<D>& at, const Matrix<D>& strain,
                 double weight, const Eigen::Matrix<double, D, Eigen::Dynamic>& slope, const int* nodes,
                 const std::vector<Matrix<D>>& rates, MapDerivative<D>* out) {
  for (std::size_t k = 0; k < rates.size(); ++k) {
    const Matrix<D>& Y = rates[k];
    const Matrix<D> d_f = -strain * Y;
    const auto column = static_cast<Eigen::Index>(k);
    out->energy(column) += weight * (at.energy * Y.trace() + at.stress.cwiseProduct(d_f).sum());
    const Matrix<D> d_stress = elasticity::tangentTimes<D>(shared, at, d_f);
    const Matrix<D> rate = weight * (Y.trace() * at.stress + d_stress - at.stress * Y.transpose());
    for (Eigen::Index a = 0; a < slope.cols(); ++a) {
      out->force.template block<D, 1>(D * nodes[a], column) += rate * slope.col(a);
    }
  }
}

}  // namespace

template <int D>
MapDerivative<D> mapDerivative(const Discretisation<D>& solid, const Eigen::VectorXd& u,
                               const std::vector<std::vector<Matrix<D>>>& rates) {
  if (static_cast<int>(rates.size()) != solid.bodyCount() || u.size() != solid.dofCount()) {
    throw common::Error("map derivative: rates of " + std::to_string(rates.size()) + " bodies and " +
                        std::to_string(u.size()) + " displacements for " + std::to_string(solid.bodyCount()) +
                        " bodies and " + std::to_string(solid.dofCount()));
  }
  const auto parameters = static_cast<Eigen::Index>(rates.front().size());
  MapDerivative<D> out{Eigen::VectorXd::Zero(parameters), Eigen::MatrixXd::Zero(solid.dofCount(), parameters)};
  elasticity::Response<D> response;
  Eigen::Matrix<double, D, Eigen::Dynamic> moved(D, solid.stencil()), slope(D, solid.stencil());
  for (int c = 0; c < solid.cellCount(); ++c) {
    const Cell& cell = solid.cell(c);
    for (int a = 0; a < solid.stencil(); ++a) moved.col(a) = u.template segment<D>(D * solid.cellNodes(c)[a]);
    for (const Term& term : solid.terms(cell.kind)) {
      const QuadratureRule<D>& rule = solid.rule(term.rule);
      const elasticity::ConstitutiveModel<D>& law = solid.model(term.model);
      const elasticity::DensityInterpolation::Value state = law.prepare(cell.density);
      const elasticity::SharedTangent shared = law.shared(state, elasticity::Order::TANGENT);
      for (int p = 0; p < rule.size(); ++p) {
        slope = Eigen::Map<const Eigen::Matrix<double, D, Eigen::Dynamic>>(rule.slopeOf(p), D, solid.stencil());
        const Matrix<D> strain = moved * slope.transpose();
        const bool good =
            law.evaluatePrepared(Matrix<D>::Identity() + strain, state, elasticity::Order::TANGENT, response);
        if (!good) throw common::Error("map derivative: cell " + std::to_string(c) + " is inverted (det F <= 0)");
        addParticle<D>(shared, response, strain, cell.measure * rule.weight[p], slope, solid.cellNodes(c),
                       rates[solid.cellBody(c)], &out);
      }
    }
  }
  return out;
}

template void mapRule<2>(const Matrix<2>&, QuadratureRule<2>*);
template void mapRule<3>(const Matrix<3>&, QuadratureRule<3>*);
template MapDerivative<2> mapDerivative<2>(const Discretisation<2>&, const Eigen::VectorXd&,
                                           const std::vector<std::vector<Matrix<2>>>&);
template MapDerivative<3> mapDerivative<3>(const Discretisation<3>&, const Eigen::VectorXd&,
                                           const std::vector<std::vector<Matrix<3>>>&);

}  // namespace snapwing::mpm
