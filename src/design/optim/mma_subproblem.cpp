#include "mma_subproblem.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "snapwing/common/elementary.h"

namespace snapwing::design {

/// Value, gradient and negative curvature of the dual with barrier, and the x that belongs to lambda.
struct MmaSubproblem::Dual {
  double value = 0;
  Eigen::VectorXd gradient;   ///< of the dual alone
  Eigen::MatrixXd curvature;  ///< lower half
  Eigen::VectorXd x;
};

Eigen::VectorXd MmaSubproblem::values(const Eigen::VectorXd& x) const {
  const Eigen::VectorXd above = (high - x).cwiseInverse(), below = (x - low).cwiseInverse();
  return r + p.transpose() * above + q.transpose() * below;
}

Eigen::VectorXd MmaSubproblem::primal(const Eigen::VectorXd& lambda) const {
  Eigen::VectorXd weight(lambda.size() + 1);
  weight << 1.0, lambda;
  const Eigen::ArrayXd root_p = (p * weight).array().sqrt(), root_q = (q * weight).array().sqrt();
  const Eigen::ArrayXd x = (root_p * low.array() + root_q * high.array()) / (root_p + root_q);
  return x.max(alpha.array()).min(beta.array());
}

/// Curvature of the dual's smooth part, its lower half. Only variables between their bounds answer to the multipliers,
/// and most lie on one.
Eigen::MatrixXd MmaSubproblem::curvatureAt(const Eigen::VectorXd& weight, const Eigen::VectorXd& x) const {
  std::vector<Eigen::Index> inside;
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    if (x(j) > alpha(j) && x(j) < beta(j)) inside.push_back(j);
  }
  const Eigen::MatrixXd up = p(inside, Eigen::all), down = q(inside, Eigen::all);
  const Eigen::ArrayXd above = (high - x)(inside).array().inverse(), below = (x - low)(inside).array().inverse();
  const Eigen::ArrayXd second = 2 * ((up * weight).array() * above.cube() + (down * weight).array() * below.cube());
  const Eigen::ArrayXd root = second.sqrt().inverse(), by_above = root * above.square(),
                       by_below = root * below.square();
  const Eigen::Index m = weight.size() - 1;
  Eigen::MatrixXd slope(up.rows(), m);
  for (Eigen::Index i = 0; i < m; ++i) {
    slope.col(i) = by_above * up.col(i + 1).array() - by_below * down.col(i + 1).array();
  }
  Eigen::MatrixXd curvature = Eigen::MatrixXd::Zero(m, m);
  curvature.selfadjointView<Eigen::Lower>().rankUpdate(slope.transpose());
  return curvature;
}

MmaSubproblem::Dual MmaSubproblem::dual(const Eigen::VectorXd& lambda, double barrier, bool curvature) const {
  const int m = static_cast<int>(lambda.size());
  Dual d;
  d.x = primal(lambda);
  const Eigen::VectorXd f = values(d.x);
  const Eigen::VectorXd y = (lambda.array() - penalty).max(0.0);
  d.gradient = f.tail(m) - y;
  d.value = f(0) + lambda.dot(f.tail(m)) - 0.5 * y.squaredNorm() + barrier * lambda.unaryExpr(&common::log).sum();
  if (!curvature) return d;
  Eigen::VectorXd weight(m + 1);
  weight << 1.0, lambda;
  d.curvature = curvatureAt(weight, d.x);
  for (int i = 0; i < m; ++i)
    d.curvature(i, i) += (lambda(i) > penalty ? 1.0 : 0.0) + barrier / (lambda(i) * lambda(i));
  return d;
}

Eigen::VectorXd MmaSubproblem::solve(Eigen::VectorXd* multipliers) const {
  const int m = static_cast<int>(p.cols()) - 1;
  if (m == 0) return primal(Eigen::VectorXd());
  constexpr double LAST_BARRIER = 1e-9;
  Eigen::VectorXd lambda = Eigen::VectorXd::Ones(m);
  for (double barrier = 1; barrier > LAST_BARRIER; barrier *= 0.1) {
    for (int k = 0; k < 60; ++k) {
      const Dual at = dual(lambda, barrier, true);
      const Eigen::VectorXd slope = at.gradient + barrier * lambda.cwiseInverse();
      // Ascent in the scaled variable: the residual lambda * slope goes to zero at the centre.
      if ((lambda.array() * slope.array()).abs().maxCoeff() < 0.1 * barrier) break;
      const Eigen::VectorXd step = at.curvature.ldlt().solve(slope);
      double length = 1;
      for (int i = 0; i < m; ++i) {
        if (step(i) < 0) length = std::min(length, -0.95 * lambda(i) / step(i));
      }
      const double rise = slope.dot(step);
      bool moved = false;
      for (int trial = 0; trial < 40 && !moved; ++trial, length *= 0.5) {
        const Eigen::VectorXd candidate = lambda + length * step;
        if (dual(candidate, barrier, false).value < at.value + 1e-4 * length * rise) continue;
        lambda = candidate;
        moved = true;
      }
      if (!moved) break;
    }
  }
  if (multipliers) *multipliers = lambda;
  return primal(lambda);
}

}  // namespace snapwing::design
