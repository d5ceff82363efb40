#include "snapwing/solver/sensitivity.h"

#include <utility>

namespace snapwing::solver {

Variation Sensitivity::tangent() const {
  Eigen::VectorXd load, control_part, driven;
  problem_->controlTangent(at_, Eigen::VectorXd::Ones(1), load, control_part);
  if (problem_->constraints() != nullptr) driven = problem_->constraints()->control().col(0);
  Eigen::VectorXd slope, multipliers;
  system_->solve(-load, driven, slope, multipliers);
  Variation variation = tangent(slope);
  variation.multipliers = std::move(multipliers);
  return variation;
}

Variation Sensitivity::tangent(const Eigen::VectorXd& slope) const {
  return {slope, {}, problem_->coordinates().push(at_.place, slope, Eigen::VectorXd::Ones(1))};
}

Variation Sensitivity::adjoint(const Eigen::VectorXd& functional) const {
  const Coordinates& coordinates = problem_->coordinates();
  Eigen::VectorXd all = Eigen::VectorXd::Zero(coordinates.fullCount()), closed;
  all.head(functional.size()) = functional;
  if (problem_->constraints() != nullptr) closed = Eigen::VectorXd::Zero(problem_->constraints()->count());
  Variation variation;
  system_->solve(-coordinates.pullBack(at_.place, all), closed, variation.z, variation.multipliers);
  variation.y = coordinates.push(at_.place, variation.z, Eigen::VectorXd::Zero(problem_->controlCount()));
  return variation;
}

Eigen::VectorXd Sensitivity::along(const Variation& direction) const {
  return problem_->densityDerivative(at_, &direction.y, cells_);
}

Eigen::VectorXd Sensitivity::potential() const { return problem_->densityDerivative(at_, nullptr, cells_); }

}  // namespace snapwing::solver
