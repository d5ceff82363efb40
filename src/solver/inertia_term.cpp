#include "snapwing/solver/inertia_term.h"

namespace snapwing::solver {

template <int D>
void InertiaTerm<D>::evaluate(const Point& at, Order order, Sum& sum) const {
  if (at.step == nullptr) return;
  const Step& step = *at.step;
  const std::vector<double>& blocks = mass_->blocks();
  const Eigen::VectorXd away = at.y - step.y0 - step.h * step.v0;
  const auto own = away.segment(first_, away.size() - first_);
  const Eigen::VectorXd force = step.kappa * mass_->multiply(own);
  sum.energy += 0.5 * force.dot(own.head(force.size()));
  if (order == Order::ENERGY) return;
  sum.gradient.segment(first_, force.size()) += force;
  sum.noteForce(force.norm());
  sum.noteRounding(std::numeric_limits<double>::epsilon() * step.kappa * rows_ * at.y.lpNorm<Eigen::Infinity>());
  if (!elasticity::withTangent(order)) return;
  double* values = sum.hessian.data() + sum.region_place[region_];
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    for (int i = 0; i < D; ++i) values[k * D * D + i + D * i] += step.kappa * blocks[k];
  }
}

template class InertiaTerm<2>;
template class InertiaTerm<3>;

}  // namespace snapwing::solver
