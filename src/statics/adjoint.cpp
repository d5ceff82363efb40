#include "snapwing/statics/adjoint.h"

namespace snapwing::statics {

template <int D>
Adjoint<D>::Adjoint(const SolidProblem<D>& problem, const Evaluation& at, Cholesky& cholesky)
    : problem_(problem), at_(at), cholesky_(cholesky) {
  negative_pivots_ = cholesky.factorize(at.hessian) ? 0 : cholesky.factorizeIndefinite(at.hessian);
}

template <int D>
Eigen::VectorXd Adjoint<D>::pathTangent(int control, double& stiffness) const {
  const Eigen::VectorXd dp = Eigen::VectorXd::Unit(problem_.controlCount(), control);
  Eigen::VectorXd free_part, control_part;
  problem_.controlTangent(at_, dp, free_part, control_part);
  const Eigen::VectorXd dz = -cholesky_.solve(free_part);
  stiffness = control_part(control) + free_part.dot(dz);
  return problem_.reduction().expandDirection(dz, dp);
}

template <int D>
Eigen::VectorXd Adjoint<D>::reaction(int control) const {
  double unused = 0;
  return problem_.solid().densityDerivative(at_.displacements, pathTangent(control, unused));
}

template <int D>
double Adjoint<D>::stiffness(int control) const {
  double result = 0;
  pathTangent(control, result);
  return result;
}

template <int D>
Eigen::MatrixXd Adjoint<D>::functionals(const Eigen::MatrixXd& by_displacement) const {
  const Reduction& reduction = problem_.reduction();
  Eigen::MatrixXd right(problem_.freeCount(), by_displacement.cols());
  for (Eigen::Index k = 0; k < right.cols(); ++k) right.col(k) = reduction.restrictToFree(by_displacement.col(k));
  const Eigen::MatrixXd states = cholesky_.solve(right);
  const Eigen::VectorXd held = Eigen::VectorXd::Zero(problem_.controlCount());
  Eigen::MatrixXd result(problem_.solid().cellCount(), right.cols());
  for (Eigen::Index k = 0; k < right.cols(); ++k) {
    result.col(k) =
        -problem_.solid().densityDerivative(at_.displacements, reduction.expandDirection(states.col(k), held));
  }
  return result;
}

template <int D>
Eigen::VectorXd Adjoint<D>::energy() const {
  return problem_.solid().densityDerivative(at_.displacements, Eigen::VectorXd());
}

template class Adjoint<2>;
template class Adjoint<3>;

}  // namespace snapwing::statics
