#include "snapwing/solver/sensitivity.h"

namespace snapwing::solver {

template <int D>
Eigen::VectorXd Sensitivity<D>::residualSlope(const Eigen::VectorXd& v) const {
  Eigen::VectorXd result = problem_.solid().densityDerivative(at_.displacements, v);
  if (load_slope_) result -= load_slope_(v.size() > 0 ? v : at_.displacements);
  return result;
}

template <int D>
Eigen::VectorXd Sensitivity<D>::reaction() const {
  const Eigen::VectorXd dp = Eigen::VectorXd::Ones(1);
  Eigen::VectorXd free_part, control_part;
  problem_.controlTangent(at_, dp, free_part, control_part);
  return reaction(-cholesky_.solve(free_part));
}

template <int D>
Eigen::VectorXd Sensitivity<D>::reaction(const Eigen::VectorXd& slope) const {
  return residualSlope(problem_.reduction().expandDirection(slope, Eigen::VectorXd::Ones(1)));
}

template <int D>
Eigen::VectorXd Sensitivity<D>::displacement(const Eigen::VectorXd& functional) const {
  const Eigen::VectorXd adjoint = -cholesky_.solve(problem_.reduction().restrictToFree(functional));
  return residualSlope(problem_.reduction().expandDirection(adjoint, Eigen::VectorXd::Zero(problem_.controlCount())));
}

template <int D>
Eigen::VectorXd Sensitivity<D>::energy() const {
  return residualSlope({});
}

template <int D>
Eigen::VectorXd cellVolumes(const mpm::Discretisation<D>& solid) {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(solid.cellCount());
  for (int c = 0; c < solid.cellCount(); ++c) {
    const mpm::QuadratureRule<D>& rule = solid.rule(solid.terms(solid.cell(c).kind)[0].rule);
    for (const double w : rule.weight) result(c) += w * solid.cell(c).measure;
  }
  return result;
}

template Eigen::VectorXd cellVolumes(const mpm::Discretisation<2>& solid);
template Eigen::VectorXd cellVolumes(const mpm::Discretisation<3>& solid);
template class Sensitivity<2>;
template class Sensitivity<3>;

}  // namespace snapwing::solver
