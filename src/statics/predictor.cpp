#include "snapwing/statics/predictor.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace snapwing::statics {

void Predictor::clear() {
  points_.clear();
  best_ = 1;
}

void Predictor::add(double p, const Eigen::VectorXd& z, const Eigen::VectorXd& slope) {
  if (!points_.empty()) {
    double least = std::numeric_limits<double>::infinity();
    for (int n = 1; n <= usable(p); ++n) {
      const double error = (extrapolate(n, p, false) - z).norm();
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
  for (std::size_t k = points_.size() - 1; k > 0; --k, ++count) {
    const double spacing = points_[k].p - points_[k - 1].p;
    if (!(spacing * step > 0) || std::abs(step) > 1.5 * std::abs(spacing)) break;
  }
  return count;
}

/// Hermite's polynomial in Lagrange's form: with L_i(p) = prod (p - p_j) / (p_i - p_j) it is the sum over the points of
/// L_i^2 ((1 - 2 L_i'(p_i) (p - p_i)) z_i + (p - p_i) dz_i/dp).
/// @param derivative  its derivative instead; p is none of the points then
Eigen::VectorXd Predictor::extrapolate(int points, double p, bool derivative) const {
  const std::size_t first = points_.size() - points;
  Eigen::VectorXd value = Eigen::VectorXd::Zero(points_.back().z.size());
  for (std::size_t i = first; i < points_.size(); ++i) {
    double basis = 1, basis_slope = 0, growth = 0;  // L_i(p), L_i'(p_i), L_i'(p) / L_i(p)
    for (std::size_t j = first; j < points_.size(); ++j) {
      if (j == i) continue;
      const double spacing = points_[i].p - points_[j].p;
      basis *= (p - points_[j].p) / spacing;
      basis_slope += 1 / spacing;
      growth += 1 / (p - points_[j].p);
    }
    const double ahead = p - points_[i].p, square = basis * basis, of_z = 1 - 2 * basis_slope * ahead;
    if (derivative) {
      const double square_slope = 2 * square * growth;
      value += (square_slope * of_z - 2 * square * basis_slope) * points_[i].z +
               (square_slope * ahead + square) * points_[i].slope;
    } else {
      value += square * of_z * points_[i].z + square * ahead * points_[i].slope;
    }
  }
  return value;
}

Eigen::VectorXd Predictor::guess(double p) const { return extrapolate(std::min(best_, usable(p)), p, false); }

Eigen::VectorXd Predictor::slopeGuess(double p) const { return extrapolate(std::min(best_, usable(p)), p, true); }

}  // namespace snapwing::statics
