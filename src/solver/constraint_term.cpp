#include "snapwing/solver/constraint_term.h"

#include <utility>

namespace snapwing::solver {

ConstraintTerm::ConstraintTerm(std::shared_ptr<const Constraints> constraints) : constraints_(std::move(constraints)) {
  if (constraints_->penalty() == 0) return;
  const ConstraintRows& rows = constraints_->linear().rows;
  for (int row = 0; row < constraints_->count(); ++row) {
    std::vector<int>& own = couples_.emplace_back();
    for (ConstraintRows::InnerIterator at(rows, row); at; ++at) own.push_back(static_cast<int>(at.col()));
  }
}

void ConstraintTerm::evaluate(const Point& at, Order order, Sum& sum) const {
  const Constraints& c = *constraints_;
  const double rho = c.penalty();
  const Eigen::VectorXd residual = c.residual(at.y, at.p);
  Eigen::VectorXd force = rho * residual;
  sum.energy += 0.5 * rho * residual.squaredNorm();
  if (at.multipliers != nullptr) {
    sum.energy += at.multipliers->dot(residual);
    force += *at.multipliers;
  }
  if (order == Order::ENERGY) return;
  const Eigen::VectorXd full = c.linear().rows.transpose() * force;
  sum.gradient += full;
  sum.control -= c.control().transpose() * force;
  sum.noteForce(full.norm());
  if (!elasticity::withTangent(order) || rho == 0) return;
  for (int row = 0; row < c.count(); ++row) {
    int place = (*sum.couples)[row];
    for (ConstraintRows::InnerIterator b(c.linear().rows, row); b; ++b) {
      for (ConstraintRows::InnerIterator a = b; a; ++a) sum.hessian[place++] += rho * a.value() * b.value();
    }
  }
}

void ConstraintTerm::controlTangent(const Point&, const Eigen::VectorXd& dy, const Eigen::VectorXd& dp,
                                    Eigen::VectorXd& by_y, Eigen::VectorXd& by_p) const {
  const Constraints& c = *constraints_;
  const Eigen::VectorXd moved = c.penalty() * (c.control() * dp);
  by_y -= c.linear().rows.transpose() * moved;
  by_p += c.control().transpose() * (moved - c.penalty() * (c.linear().rows * dy));
}

}  // namespace snapwing::solver
