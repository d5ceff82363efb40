#include "snapwing/solver/problem.h"

#include <algorithm>

namespace snapwing::solver {

void Problem::evaluateLagrangian(const Eigen::VectorXd& z, const Eigen::VectorXd& p, const Eigen::VectorXd&,
                                 Order order, Evaluation& out) const {
  evaluate(z, p, order, out);
}

double meanStiffness(const Problem& problem) {
  Evaluation rest;
  problem.evaluate(Eigen::VectorXd::Zero(problem.freeCount()), Eigen::VectorXd::Zero(problem.controlCount()),
                   Order::TANGENT, rest);
  double sum = 0;
  int stiff = 0;
  for (int c = 0; c < problem.freeCount(); ++c) {
    const double own = rest.hessian[problem.pattern().start[c]];
    sum += own;
    stiff += own > 0 ? 1 : 0;
  }
  return sum / std::max(stiff, 1);
}

}  // namespace snapwing::solver
