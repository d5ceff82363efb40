#include "conjugate_gradients.h"

#include <cmath>

namespace snapwing::solver {

CgResult conjugateGradients(const SparsePattern& pattern, const std::vector<double>& values, const Cholesky& factor,
                            const Eigen::VectorXd& b, double tolerance, int max_iterations, Eigen::VectorXd& x) {
  CgResult result;
  Eigen::VectorXd r = b, d;
  if (x.size() == b.size()) {
    r -= pattern.multiply(values, x);
  } else {
    x = Eigen::VectorXd::Zero(b.size());
  }
  double old_product = 0;
  while (result.iterations < max_iterations) {
    const Eigen::VectorXd s = factor.precondition(r);
    ++result.iterations;
    const double product = r.dot(s);
    if (result.iterations == 1) {
      d = s;
    } else {
      d *= product / old_product;
      d += s;
    }
    const Eigen::VectorXd ad = pattern.multiply(values, d);
    const double curvature = d.dot(ad);
    if (!(curvature > 0) || !(product > 0)) {
      result.positive = false;
      return result;
    }
    const double length = product / curvature;
    x += length * d;
    r -= length * ad;
    old_product = product;
    if (r.norm() <= tolerance) {
      result.converged = true;
      return result;
    }
  }
  return result;
}

}  // namespace snapwing::solver
