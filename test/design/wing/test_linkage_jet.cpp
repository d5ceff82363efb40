// Jets against central differences of the same expression, first and second order.
#include <gtest/gtest.h>

#include "linkage_jet.h"

namespace snapwing::design {
namespace {

template <class S>
S expression(const S& x, const S& y, const S& z) {
  using std::atan2;
  using std::cos;
  using std::sin;
  using std::sqrt;
  return atan2(x * y - 2.0, z + 1.5) * sqrt(x + y * y) / (2.0 + cos(z)) - (3.0 - x) * sin(y / 2.0) + 1.0 / z - (-x);
}

TEST(LinkageJet, GradientAndHessianMatchDifferences) {
  const Eigen::Vector3d at(0.7, 1.9, 0.4);
  const auto value = [](const Eigen::Vector3d& v) { return expression(v[0], v[1], v[2]); };
  using J = Jet<3>;
  const J jet = expression(J::variable(at[0], 0), J::variable(at[1], 1), J::variable(at[2], 2));
  EXPECT_DOUBLE_EQ(jet.value, value(at));
  double last = 0;
  for (const double step : {1e-2, 1e-3, 1e-4}) {
    double worst = 0;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d e = step * Eigen::Vector3d::Unit(i);
      worst = std::max(worst, std::abs((value(at + e) - value(at - e)) / (2 * step) - jet.gradient[i]));
      for (int j = 0; j < 3; ++j) {
        const Eigen::Vector3d f = step * Eigen::Vector3d::Unit(j);
        const double second =
            (value(at + e + f) - value(at + e - f) - value(at - e + f) + value(at - e - f)) / (4 * step * step);
        worst = std::max(worst, std::abs(second - jet.hessian(i, j)));
      }
    }
    if (last > 0) {
      // Second order: a tenth of the step, a hundredth of the error, until rounding of the second difference counts.
      EXPECT_LT(worst, 0.02 * last + 1e-7);
    }
    last = worst;
  }
  EXPECT_GT(jet.gradient.cwiseAbs().minCoeff(), 1e-3);
  EXPECT_TRUE(jet.hessian.isApprox(jet.hessian.transpose()));
}

}  // namespace
}  // namespace snapwing::design
