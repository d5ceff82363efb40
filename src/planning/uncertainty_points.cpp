#include "snapwing/planning/uncertainty_points.h"

#include <boost/random/sobol.hpp>

namespace snapwing::planning {

std::vector<BoxPoint> sobolPoints(int dimension, int count, int first) {
  boost::random::sobol engine(dimension);
  engine.discard(static_cast<std::uintmax_t>(first) * dimension);
  // The engine yields integers; the middle of each cell keeps the ends of the box out.
  const double width = static_cast<double>(engine.max()) + 1.0;
  std::vector<BoxPoint> points(count, BoxPoint(dimension));
  for (BoxPoint& point : points) {
    for (double& x : point) x = 2.0 * (static_cast<double>(engine()) / width) - 1.0;
  }
  return points;
}

std::vector<BoxPoint> axisPoints(int dimension) {
  std::vector<BoxPoint> points(2 * dimension, BoxPoint(dimension, 0.0));
  for (int i = 0; i < dimension; ++i) {
    points[2 * i][i] = -1.0;
    points[2 * i + 1][i] = 1.0;
  }
  return points;
}

std::vector<BoxPoint> cornerPoints(int dimension, const std::vector<int>& coordinates) {
  std::vector<BoxPoint> points(std::size_t{1} << coordinates.size(), BoxPoint(dimension, 0.0));
  for (std::size_t corner = 0; corner < points.size(); ++corner) {
    for (std::size_t k = 0; k < coordinates.size(); ++k) {
      points[corner][coordinates[k]] = (corner >> k) & 1 ? 1.0 : -1.0;
    }
  }
  return points;
}

}  // namespace snapwing::planning
