#include "snapwing/statics/predictor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "snapwing/common/wide.h"

namespace snapwing::statics {

namespace {

/// Of a point's z and slope in the sum that a guess is.
struct Weights {
  double of_z, of_slope;
};

/// Hermite's polynomial through the last `count` points in Lagrange's form: with L_i(p) = prod (p - p_j) / (p_i - p_j)
/// it is the sum over them of L_i^2 ((1 - 2 L_i'(p_i) (p - p_i)) z_i + (p - p_i) dz_i/dp).
/// @param derivative  its derivative instead; p is none of the points then
template <class Points>
std::vector<Weights> hermite(const Points& points, int count, double p, bool derivative) {
  const std::size_t first = points.size() - count;
  std::vector<Weights> weights;
  for (std::size_t i = first; i < points.size(); ++i) {
    double basis = 1, basis_slope = 0, growth = 0;  // L_i(p), L_i'(p_i), L_i'(p) / L_i(p)
    for (std::size_t j = first; j < points.size(); ++j) {
      if (j == i) continue;
      const double spacing = points[i].p - points[j].p;
      basis *= (p - points[j].p) / spacing;
      basis_slope += 1 / spacing;
      growth += 1 / (p - points[j].p);
    }
    const double ahead = p - points[i].p, square = basis * basis, of_z = 1 - 2 * basis_slope * ahead;
    if (derivative) {
      const double square_slope = 2 * square * growth;
      weights.push_back({square_slope * of_z - 2 * square * basis_slope, square_slope * ahead + square});
    } else {
      weights.push_back({square * of_z, square * ahead});
    }
  }
  return weights;
}

/// value += w.of_z z + w.of_slope slope
SNAPWING_WIDE void addShare(const Weights& w, const double* __restrict z, const double* __restrict slope,
                            Eigen::Index count, double* __restrict value) {
  const double of_z = w.of_z, of_slope = w.of_slope;
  for (Eigen::Index k = 0; k < count; ++k) value[k] += of_z * z[k] + of_slope * slope[k];
}

/// The guesses by several polynomials, block by block: points and sums stay in the nearest cache, and each point is
/// read once for all of them.
template <class Points>
std::vector<Eigen::VectorXd> sums(const Points& points, const std::vector<std::vector<Weights>>& polynomials) {
  constexpr Eigen::Index BLOCK = 256;
  const Eigen::Index size = points.back().z.size();
  std::vector<Eigen::VectorXd> values;
  for (std::size_t n = 0; n < polynomials.size(); ++n) values.emplace_back(size);
  for (Eigen::Index from = 0; from < size; from += BLOCK) {
    const Eigen::Index count = std::min(BLOCK, size - from);
    for (std::size_t n = 0; n < polynomials.size(); ++n) {
      values[n].segment(from, count).setZero();
      auto point = points.end() - static_cast<std::ptrdiff_t>(polynomials[n].size());
      for (const Weights& w : polynomials[n]) {
        addShare(w, point->z.data() + from, point->slope.data() + from, count, values[n].data() + from);
        ++point;
      }
    }
  }
  return values;
}

}  // namespace

void Predictor::clear() {
  points_.clear();
  best_ = 1;
}

void Predictor::add(double p, const Eigen::VectorXd& z, const Eigen::VectorXd& slope) {
  if (!points_.empty()) {
    const int most = usable(p);
    std::vector<std::vector<Weights>> polynomials;
    for (int n = 1; n <= most; ++n) polynomials.push_back(hermite(points_, n, p, false));
    const std::vector<Eigen::VectorXd> guesses = sums(points_, polynomials);
    double least = std::numeric_limits<double>::infinity();
    for (int n = 1; n <= most; ++n) {
      const double error = (guesses[n - 1] - z).norm();
      if (error < least) {
        least = error;
        best_ = n;
      }
    }
    // One point more than before has not been tried yet: let it show what it can.
    if (best_ == most) ++best_;
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

Eigen::VectorXd Predictor::extrapolate(int points, double p, bool derivative) const {
  return std::move(sums(points_, {hermite(points_, points, p, derivative)}).front());
}

Eigen::VectorXd Predictor::guess(double p) const { return extrapolate(std::min(best_, usable(p)), p, false); }

Eigen::VectorXd Predictor::slopeGuess(double p) const { return extrapolate(std::min(best_, usable(p)), p, true); }

}  // namespace snapwing::statics
