#pragma once
/// First guess of a path's next point by extrapolation from the last points and their tangents dz/dp.
///
/// Candidates are the Hermite polynomials through the last 1 to 5 points: the tangent, a cubic, up to order 9. The one
/// with the smallest error at the last point is chosen; after a kink of the path this is the tangent.

#include <Eigen/Core>
#include <vector>

namespace snapwing::statics {

class Predictor {
 public:
  static constexpr std::size_t MOST_POINTS = 5;

  /// Discards all points: another branch follows.
  void clear();
  /// Adds a converged point with its tangent. @param z  [m]; @param slope  dz/dp
  void add(double p, const Eigen::VectorXd& z, const Eigen::VectorXd& slope);
  /// Guess of z at p [m]. Requires at least one point.
  Eigen::VectorXd guess(double p) const;
  /// Guess of dz/dp there: of the same polynomial.
  Eigen::VectorXd slopeGuess(double p) const;

 private:
  struct Point {
    double p;
    Eigen::VectorXd z, slope;
  };
  Eigen::VectorXd extrapolate(int points, double p, bool derivative) const;
  int usable(double p) const;

  std::vector<Point> points_;  ///< newest last
  int best_ = 1;               ///< number of points with the smallest error at the newest
};

}  // namespace snapwing::statics
