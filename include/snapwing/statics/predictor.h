#pragma once
/// First guess of a path's next point from the last ones and their tangents dz/dp.
///
/// Candidates are the Hermite polynomials through the last 1 to 5 points: tangent, cubic, .. order 9. The one is taken
/// that would have met the last point best, so that a path with a kink falls back to its tangent.

#include <Eigen/Core>
#include <vector>

namespace snapwing::statics {

class Predictor {
 public:
  static constexpr std::size_t MOST_POINTS = 5;

  /// Forgets the path: what follows is another branch.
  void clear();
  /// A converged point with its tangent.
  void add(double p, const Eigen::VectorXd& z, const Eigen::VectorXd& slope);
  /// Guess at p. Needs at least one point.
  Eigen::VectorXd guess(double p) const;

 private:
  struct Point {
    double p;
    Eigen::VectorXd z, slope;
  };
  Eigen::VectorXd extrapolate(int points, double p) const;
  int usable(double p) const;

  std::vector<Point> points_;  ///< newest last
  int best_ = 1;               ///< number of points that would have met the newest best
};

}  // namespace snapwing::statics
