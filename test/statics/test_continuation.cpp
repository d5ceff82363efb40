// What lets a path go on cheaply: guesses, old factors, and the distance that says whether an old factor still speaks
// for the stability of a point.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "conjugate_gradients.h"
#include "snapwing/statics/predictor.h"

namespace snapwing::statics {
namespace {

/// Springs in a row with stiffness k_c between neighbours, both ends held.
solver::SparsePattern springPattern(int n) {
  solver::SparsePattern pattern;
  pattern.size = n;
  pattern.start = {0};
  for (int c = 0; c < n; ++c) {
    pattern.row.push_back(c);
    if (c + 1 < n) pattern.row.push_back(c + 1);
    pattern.start.push_back(pattern.entries());
  }
  return pattern;
}

std::vector<double> springValues(int n, double change) {
  std::vector<double> values;
  const auto k = [&](int c) { return 1 + change * std::sin(c); };
  for (int c = 0; c < n; ++c) {
    values.push_back(k(c) + k(c + 1));
    if (c + 1 < n) values.push_back(-k(c + 1));
  }
  return values;
}

TEST(ConjugateGradients, SolveWithTheFactorOfANearbyMatrix) {
  const int n = 400;
  const solver::SparsePattern pattern = springPattern(n);
  solver::Cholesky cholesky(pattern);
  ASSERT_TRUE(cholesky.factorize(springValues(n, 0)));
  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(n, -1, 2);
  Eigen::VectorXd x;
  int last = 0;
  for (const double change : {0.0, 0.01, 0.3}) {
    const std::vector<double> values = springValues(n, change);
    const solver::CgResult result = solver::conjugateGradients(pattern, values, cholesky, b, 1e-10 * b.norm(), 60, x);
    ASSERT_TRUE(result.converged) << change;
    EXPECT_LE((pattern.multiply(values, x) - b).norm(), 1.01e-10 * b.norm());
    EXPECT_GE(result.iterations, last);
    last = result.iterations;
  }
  EXPECT_LT(last, 40);
  std::vector<double> indefinite = springValues(n, 0);
  for (double& value : indefinite) value = -value;
  EXPECT_FALSE(solver::conjugateGradients(pattern, indefinite, cholesky, b, 1e-10, 60, x).positive);
}

TEST(Cholesky, DistanceIsThatOfTheLargestRelativeEigenvalue) {
  const int n = 60;
  const solver::SparsePattern pattern = springPattern(n);
  solver::Cholesky cholesky(pattern);
  EXPECT_TRUE(std::isinf(cholesky.distance(springValues(n, 0))));
  const std::vector<double> values = springValues(n, 0);
  ASSERT_TRUE(cholesky.factorize(values));
  EXPECT_LT(cholesky.distance(values), 1e-12);
  std::vector<double> scaled = values;
  for (double& value : scaled) value *= 1.05;
  EXPECT_NEAR(cholesky.distance(scaled), 0.05, 1e-9);
  // A matrix that has lost its definiteness is at least 1 away, and two steps must see most of it.
  std::vector<double> lost = values;
  for (int c = 0; c < n; ++c) lost[pattern.start[c]] -= 0.01;  // the softest eigenvalue is 2 - 2 cos(pi/61) = .0027
  ASSERT_FALSE(solver::Cholesky(pattern).factorize(lost));
  EXPECT_GT(cholesky.distance(lost), 1);
}

Eigen::VectorXd curve(double p) { return Eigen::Vector3d(1 + p, p * p * p - p, std::pow(p, 5) - 2 * std::pow(p, 4)); }
Eigen::VectorXd slope(double p) { return Eigen::Vector3d(1, 3 * p * p - 1, 5 * std::pow(p, 4) - 8 * std::pow(p, 3)); }

TEST(Predictor, MeetsAQuinticFromThreePoints) {
  Predictor predictor;
  predictor.add(0, curve(0), slope(0));
  EXPECT_LT((predictor.guess(0.5) - (curve(0) + 0.5 * slope(0))).norm(), 1e-14) << "one point: its tangent";
  predictor.add(0.5, curve(0.5), slope(0.5));
  predictor.add(1, curve(1), slope(1));
  predictor.add(1.5, curve(1.5), slope(1.5));
  EXPECT_LT((predictor.guess(2) - curve(2)).norm(), 1e-12);
  // On the way back, the last points lie ahead: only the tangent is left.
  EXPECT_LT((predictor.guess(1.2) - (curve(1.5) - 0.3 * slope(1.5))).norm(), 1e-14);
}

TEST(Predictor, MeetsTheNinthOrderFromFivePoints) {
  Predictor predictor;
  const auto at = [](double p) { return Eigen::VectorXd::Constant(1, std::pow(p, 9) - 3 * std::pow(p, 4)); };
  const auto rise = [](double p) { return Eigen::VectorXd::Constant(1, 9 * std::pow(p, 8) - 12 * std::pow(p, 3)); };
  for (const double p : {0.0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2}) predictor.add(p, at(p), rise(p));
  EXPECT_NEAR(predictor.guess(1.4)(0), at(1.4)(0), 1e-11);
}

TEST(Predictor, FallsBackToTheTangentAfterAKink) {
  Predictor predictor;
  const auto at = [](double p) { return Eigen::VectorXd::Constant(1, p < 1 ? 0.0 : p - 1); };
  for (const double p : {0.0, 0.4, 0.8, 1.2}) {
    predictor.add(p, at(p), Eigen::VectorXd::Constant(1, p < 1 ? 0.0 : 1.0));
  }
  EXPECT_NEAR(predictor.guess(1.6)(0), 0.6, 1e-14);
}

}  // namespace
}  // namespace snapwing::statics
