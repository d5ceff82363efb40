#include "snapwing/solver/sensitivity.h"

namespace snapwing::solver {

Eigen::VectorXd Sensitivity::reaction() const {
  const Eigen::VectorXd dp = Eigen::VectorXd::Ones(1);
  Eigen::VectorXd free_part, control_part;
  problem_.controlTangent(at_, dp, free_part, control_part);
  return reaction(-cholesky_.solve(free_part));
}

Eigen::VectorXd Sensitivity::reaction(const Eigen::VectorXd& slope) const {
  const Eigen::VectorXd v = problem_.coordinates().push(at_.place, slope, Eigen::VectorXd::Ones(1));
  return problem_.densityDerivative(at_, &v, cells_);
}

Eigen::VectorXd Sensitivity::displacement(const Eigen::VectorXd& functional) const {
  const Eigen::VectorXd adjoint = -cholesky_.solve(problem_.coordinates().pullBack(at_.place, functional));
  const Eigen::VectorXd v =
      problem_.coordinates().push(at_.place, adjoint, Eigen::VectorXd::Zero(problem_.controlCount()));
  return problem_.densityDerivative(at_, &v, cells_);
}

Eigen::VectorXd Sensitivity::energy() const { return problem_.densityDerivative(at_, nullptr, cells_); }

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

}  // namespace snapwing::solver
