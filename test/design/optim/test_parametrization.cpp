// Filter, projection, patches and their chain.
#include <gtest/gtest.h>

#include <cmath>

#include "snapwing/common/error.h"
#include "snapwing/design/optim/parametrization.h"
#include "support/derivative_check.h"

namespace snapwing::design {
namespace {

/// Cells of an L of 12 x 8, 1 mm each.
std::vector<std::array<double, 2>> cells() {
  std::vector<std::array<double, 2>> result;
  for (int j = 0; j < 8; ++j) {
    for (int i = 0; i < 12; ++i) {
      if (i < 4 || j < 4) result.push_back({1e-3 * (i + 0.5), 1e-3 * (j + 0.5)});
    }
  }
  return result;
}

Eigen::VectorXd wave(int n) {
  Eigen::VectorXd x(n);
  for (int k = 0; k < n; ++k) x(k) = 0.5 + 0.4 * std::sin(2.3 * k);
  return x;
}

TEST(DensityFilter, KeepsConstantsAndAreaUpToTheEdge) {
  const DensityFilter filter(cells(), 0.0035);
  const int n = static_cast<int>(cells().size());
  EXPECT_LT((filter.eval(Eigen::VectorXd::Ones(n)).array() - 1).abs().maxCoeff(), 1e-12);
  const Eigen::VectorXd x = wave(n);
  EXPECT_NEAR(filter.eval(x).sum(), x.sum(), 1e-10);
  EXPECT_LT((filter.eval(x).array() - 0.5).matrix().norm(), 0.9 * (x.array() - 0.5).matrix().norm());
}

TEST(DensityFilter, ReachesNoFurtherThanItsRadius) {
  const auto where = cells();
  const DensityFilter filter(where, 0.0025);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(static_cast<int>(where.size()));
  x(20) = 1;
  const Eigen::VectorXd y = filter.eval(x);
  for (int k = 0; k < y.size(); ++k) {
    const double distance = std::hypot(where[k][0] - where[20][0], where[k][1] - where[20][1]);
    EXPECT_EQ(y(k) > 0, distance < 0.0025 * (1 - 1e-9)) << k;
  }
  const DensityFilter none(where, 0);
  EXPECT_EQ(none.eval(wave(x.size())), wave(x.size()));
}

TEST(Projection, EndsAndOrder) {
  const Eigen::VectorXd x = wave(50);
  for (const double b : {0.0, 1.0, 16.0}) {
    const Projection p(b, 0.4);
    EXPECT_NEAR(p.eval(Eigen::VectorXd::Zero(1))(0), 0, 1e-12);
    EXPECT_NEAR(p.eval(Eigen::VectorXd::Ones(1))(0), 1, 1e-12);
  }
  const Eigen::VectorXd eroded = Projection(8, 0.6).eval(x), dilated = Projection(8, 0.4).eval(x);
  EXPECT_TRUE((eroded.array() < dilated.array()).all());
  EXPECT_THROW(Projection(1, 0), common::Error);
  EXPECT_THROW(Projection(-1, 0.5), common::Error);
}

TEST(Chain, TransposedJacobianMatchesDifferences) {
  const auto where = cells();
  const int n = static_cast<int>(where.size());
  Eigen::VectorXd held = Eigen::VectorXd::Constant(n, -1);
  held(3) = 1, held(17) = 0;
  const auto patches = std::make_shared<Patches>(held);
  const Chain chain(
      {patches, std::make_shared<DensityFilter>(where, 0.003), std::make_shared<Projection>(6, 0.45), patches});
  const Eigen::VectorXd x = wave(n), weight = wave(n).array().square(), direction = wave(n).reverse();
  const double expected = chain.applyJacobianTranspose(x, weight).dot(direction);
  EXPECT_TRUE(test::derivativeMatches(
      [&](double h) { return Eigen::VectorXd::Constant(1, weight.dot(chain.eval(x + h * direction))); },
      Eigen::VectorXd::Constant(1, expected), 0.1, 1e-8));
  EXPECT_EQ(chain.eval(x)(3), 1);
  EXPECT_EQ(chain.eval(x)(17), 0);
}

TEST(GreyLevel, Ends) {
  EXPECT_DOUBLE_EQ(greyLevel(Eigen::VectorXd::Constant(7, 0.5)), 1);
  EXPECT_DOUBLE_EQ(greyLevel(Eigen::VectorXd::Ones(7)), 0);
}

}  // namespace
}  // namespace snapwing::design
