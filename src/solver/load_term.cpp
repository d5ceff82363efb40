#include "snapwing/solver/load_term.h"

namespace snapwing::solver {

Eigen::VectorXd LoadTerm::loadAt(const Eigen::VectorXd& p) const {
  Eigen::VectorXd load = dead_;
  if (per_control_.size() == 0) return load;
  if (load.size() == 0) load = Eigen::VectorXd::Zero(per_control_.rows());
  load += per_control_ * p;
  return load;
}

void LoadTerm::evaluate(const Point& at, Order order, Sum& sum) const {
  const Eigen::VectorXd load = loadAt(at.p);
  if (load.size() == 0) return;
  sum.energy -= load.dot(at.y.head(load.size()));
  if (order == Order::ENERGY) return;
  sum.gradient.head(load.size()) -= load;
  if (per_control_.size() > 0) sum.control -= per_control_.transpose() * at.y.head(load.size());
  sum.noteForce(load.norm());
}

void LoadTerm::controlTangent(const Point&, const Eigen::VectorXd& dy, const Eigen::VectorXd& dp, Eigen::VectorXd& by_y,
                              Eigen::VectorXd& by_p) const {
  if (per_control_.size() == 0) return;
  by_y.head(per_control_.rows()) -= per_control_ * dp;
  by_p -= per_control_.transpose() * dy.head(per_control_.rows());
}

}  // namespace snapwing::solver
