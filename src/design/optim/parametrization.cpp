#include "snapwing/design/optim/parametrization.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "snapwing/common/elementary.h"
#include "snapwing/common/error.h"

namespace snapwing::design {

Eigen::VectorXd Chain::eval(const Eigen::VectorXd& x) const {
  Eigen::VectorXd value = x;
  for (const auto& map : maps_) value = map->eval(value);
  return value;
}

Eigen::VectorXd Chain::applyJacobianTranspose(const Eigen::VectorXd& x, const Eigen::VectorXd& g) const {
  std::vector<Eigen::VectorXd> inputs{x};
  for (std::size_t k = 0; k + 1 < maps_.size(); ++k) inputs.push_back(maps_[k]->eval(inputs.back()));
  Eigen::VectorXd result = g;
  for (std::size_t k = maps_.size(); k-- > 0;) result = maps_[k]->applyJacobianTranspose(inputs[k], result);
  return result;
}

DensityFilter::DensityFilter(const std::vector<std::array<double, 2>>& centres, double radius) {
  if (!(radius >= 0)) throw common::Error("filter radius is " + std::to_string(radius) + " m; allowed: >= 0");
  const int n = static_cast<int>(centres.size());
  // Cells sorted by x: only those within the radius are compared.
  std::vector<int> order(n);
  for (int k = 0; k < n; ++k) order[k] = k;
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return centres[a][0] < centres[b][0]; });
  std::vector<Eigen::Triplet<double>> entries;
  for (int a = 0; a < n; ++a) {
    const auto& ca = centres[order[a]];
    entries.emplace_back(order[a], order[a], std::max(radius, 1e-12));
    for (int b = a + 1; b < n && centres[order[b]][0] - ca[0] < radius; ++b) {
      const auto& cb = centres[order[b]];
      const double weight = radius - common::hypot(ca[0] - cb[0], ca[1] - cb[1]);
      if (weight <= 1e-9 * radius) continue;
      entries.emplace_back(order[a], order[b], weight);
      entries.emplace_back(order[b], order[a], weight);
    }
  }
  weights_.resize(n, n);
  weights_.setFromTriplets(entries.begin(), entries.end());
  // Symmetric Sinkhorn scaling.
  Eigen::VectorXd scale = (weights_ * Eigen::VectorXd::Ones(n)).cwiseSqrt().cwiseInverse();
  for (int k = 0; k < 200; ++k) {
    const Eigen::VectorXd sums = scale.cwiseProduct(weights_ * scale);
    if ((sums.array() - 1).abs().maxCoeff() < 1e-14) break;
    scale = scale.cwiseQuotient(sums.cwiseSqrt());
  }
  weights_ = scale.asDiagonal() * weights_ * scale.asDiagonal();
}

Projection::Projection(double sharpness, double threshold) : sharpness_(sharpness), threshold_(threshold) {
  if (!(sharpness >= 0))
    throw common::Error("projection sharpness is " + std::to_string(sharpness) + "; allowed: >= 0");
  if (!(threshold > 0 && threshold < 1)) {
    throw common::Error("projection threshold is " + std::to_string(threshold) + "; allowed: in (0, 1)");
  }
}

Eigen::VectorXd Projection::eval(const Eigen::VectorXd& x) const {
  // A filter whose rows sum to one up to rounding may leave [0, 1] by as much.
  if (sharpness_ == 0) return x.cwiseMax(0.0).cwiseMin(1.0);
  const double low = common::tanh(sharpness_ * threshold_);
  const double span = low + common::tanh(sharpness_ * (1 - threshold_));
  return ((low + (sharpness_ * (x.array() - threshold_)).unaryExpr(&common::tanh)) / span).max(0.0).min(1.0);
}

Eigen::VectorXd Projection::applyJacobianTranspose(const Eigen::VectorXd& x, const Eigen::VectorXd& g) const {
  if (sharpness_ == 0) return g;
  const double span = common::tanh(sharpness_ * threshold_) + common::tanh(sharpness_ * (1 - threshold_));
  const Eigen::ArrayXd th = (sharpness_ * (x.array() - threshold_)).unaryExpr(&common::tanh);
  return g.array() * sharpness_ * (1 - th.square()) / span;
}

Eigen::VectorXd Patches::eval(const Eigen::VectorXd& x) const { return (held_.array() >= 0).select(held_, x); }

Eigen::VectorXd Patches::applyJacobianTranspose(const Eigen::VectorXd& /*x*/, const Eigen::VectorXd& g) const {
  return (held_.array() >= 0).select(Eigen::VectorXd::Zero(g.size()), g);
}

double greyLevel(const Eigen::VectorXd& density) {
  return 4 * (density.array() * (1 - density.array())).sum() / std::max<double>(1, static_cast<double>(density.size()));
}

}  // namespace snapwing::design
