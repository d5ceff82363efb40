#include "snapwing/statics/predictor.h"

#include <algorithm>
#include <cmath>

namespace snapwing::statics {

namespace {
constexpr int MOST_POINTS = 3;
}

void Predictor::clear() {
  points_.clear();
  best_ = 1;
}

void Predictor::add(double p, const Eigen::VectorXd& z, const Eigen::VectorXd& slope) {
  if (!points_.empty()) {
    double least = std::numeric_limits<double>::infinity();
    for (int n = 1; n <= usable(p); ++n) {
      const double error = (extrapolate(n, p) - z).norm();
      if (error < least) {
        least = error;
        best_ = n;
      }
    }
    // One point more than before has not been tried yet: let it show what it can.
    if (best_ == usable(p)) ++best_;
  }
  points_.push_back({p, z, slope});
  if (points_.size() > MOST_POINTS) points_.erase(points_.begin());
}

/// Far extrapolation from points that lie close together is worth nothing, and so are points with no distance.
int Predictor::usable(double p) const {
  const double step = p - points_.back().p;
  int count = 1;
  for (std::size_t k = points_.size() - 1; k > 0 && count < MOST_POINTS; --k, ++count) {
    const double spacing = points_[k].p - points_[k - 1].p;
    if (!(spacing * step > 0) || std::abs(step) > 1.5 * std::abs(spacing)) break;
  }
  return count;
}

/// Newton's divided differences with each node taken twice.
Eigen::VectorXd Predictor::extrapolate(int points, double p) const {
  const int order = 2 * points;
  const std::size_t first = points_.size() - points;
  std::vector<double> node(order);
  std::vector<Eigen::VectorXd> difference(order);
  for (int k = 0; k < order; ++k) {
    node[k] = points_[first + k / 2].p;
    difference[k] = points_[first + k / 2].z;
  }
  for (int level = 1; level < order; ++level) {
    for (int k = order - 1; k >= level; --k) {
      if (node[k] == node[k - level]) {
        difference[k] = points_[first + k / 2].slope;
      } else {
        difference[k] = (difference[k] - difference[k - 1]) / (node[k] - node[k - level]);
      }
    }
  }
  Eigen::VectorXd value = difference[order - 1];
  for (int k = order - 2; k >= 0; --k) value = difference[k] + (p - node[k]) * value;
  return value;
}

Eigen::VectorXd Predictor::guess(double p) const { return extrapolate(std::min(best_, usable(p)), p); }

}  // namespace snapwing::statics
