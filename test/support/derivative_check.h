#pragma once
/// Checks a derivative against central differences at several steps: the error must fall with the square of the step
/// until rounding, and reach a small floor. A wrong derivative fails at every step; a difference compared with itself
/// would show no slope.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>

namespace snapwing::test {

/// @param value       function of the step length along a fixed direction, vector-valued
/// @param derivative  claimed derivative at 0 along that direction
/// @param scale       natural size of a step (the first one is 1e-2 of it)
/// @param floor       relative error that must be reached
inline ::testing::AssertionResult derivativeMatches(const std::function<Eigen::VectorXd(double)>& value,
                                                    const Eigen::VectorXd& derivative, double scale, double floor) {
  const double size = derivative.norm();
  if (!(size > 0)) return ::testing::AssertionFailure() << "the derivative is zero: nothing was tested";
  double errors[4];
  std::ostringstream text;
  for (int k = 0; k < 4; ++k) {
    const double h = scale * std::pow(10.0, -2 - k);
    errors[k] = ((value(h) - value(-h)) / (2 * h) - derivative).norm() / size;
    text << " step " << h << ": relative error " << errors[k] << ";";
  }
  const double best = *std::min_element(errors, errors + 4);
  if (!(best < floor)) return ::testing::AssertionFailure() << "floor " << floor << " not reached:" << text.str();
  // The slope, wherever truncation is well above rounding.
  if (errors[0] > 100 * floor) {
    const double slope = std::log10(errors[0] / errors[1]);
    if (slope < 1.8 || slope > 2.2) return ::testing::AssertionFailure() << "slope " << slope << ":" << text.str();
  }
  return ::testing::AssertionSuccess() << text.str();
}

}  // namespace snapwing::test
