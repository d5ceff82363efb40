// What lets a path go on cheaply: guesses, old factors, and the probe that tells by an old factor whether a point is
// stable.
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
    x.resize(0);
    const solver::CgResult result = solver::conjugateGradients(pattern, values, cholesky, b, 1e-10 * b.norm(), 60, x);
    ASSERT_TRUE(result.converged) << change;
    EXPECT_LE((pattern.multiply(values, x) - b).norm(), 1.01e-10 * b.norm());
    EXPECT_GE(result.iterations, last);
    // From a guess with five digits half of the way is left.
    x *= 1 + 1e-5;
    const auto near = solver::conjugateGradients(pattern, values, cholesky, b, 1e-10 * b.norm(), 60, x);
    ASSERT_TRUE(near.converged) << change;
    EXPECT_LE((pattern.multiply(values, x) - b).norm(), 1.01e-10 * b.norm());
    EXPECT_LE(near.iterations, (3 * result.iterations + 3) / 4);
    last = result.iterations;
  }
  EXPECT_LT(last, 40);
  std::vector<double> indefinite = springValues(n, 0);
  for (double& value : indefinite) value = -value;
  EXPECT_FALSE(solver::conjugateGradients(pattern, indefinite, cholesky, b, 1e-10, 60, x).positive);
}

/// A load that has no part of the softest motion does not meet its negative curvature, however large: a hundredth of a
/// probe does, down to eigenvalues that are zero to eight digits.
TEST(ConjugateGradients, AProbeMeetsEveryNegativeEigenvalue) {
  const int n = 61;
  const solver::SparsePattern pattern = springPattern(n);
  const std::vector<double> values = springValues(n, 0);
  solver::Cholesky cholesky(pattern);
  ASSERT_TRUE(cholesky.factorize(values));
  Eigen::VectorXd soft(n), push(n);
  for (int c = 0; c < n; ++c) soft(c) = std::sin(M_PI * (c + 1) / (n + 1)), push(c) = std::sin(1.7 * c + 0.3);
  soft.normalize();
  const double softest = 2 - 2 * std::cos(M_PI / (n + 1));
  // Odd, where the softest motion is even.
  const Eigen::VectorXd load = Eigen::VectorXd::LinSpaced(n, -1, 1);
  ASSERT_LT(std::abs(load.dot(soft)), 1e-12);
  const Eigen::VectorXd probe = cholesky.solve(push);
  for (const double relative : {0.2, 1e-3, -1e-6, -1e-3, -0.2}) {
    // The softest eigenvalue of F^-1 A, by a shift of all.
    std::vector<double> shifted = values;
    for (int c = 0; c < n; ++c) shifted[pattern.start[c]] -= (1 - relative) * softest;
    const Eigen::VectorXd probe_load = pattern.multiply(shifted, probe);
    const Eigen::VectorXd right = load + 1e-2 * load.norm() / probe_load.norm() * probe_load;
    Eigen::VectorXd x;
    const double tolerance = 1e-12 * load.norm();
    const auto alone = solver::conjugateGradients(pattern, shifted, cholesky, load, tolerance, 12, x);
    // With and without a guess that is exact but for the probe.
    Eigen::VectorXd from_zero;
    const auto probed = solver::conjugateGradients(pattern, shifted, cholesky, right, tolerance, 12, from_zero);
    const auto guessed = solver::conjugateGradients(pattern, shifted, cholesky, right, tolerance, 12, x);
    EXPECT_TRUE(alone.positive) << relative;
    EXPECT_EQ(probed.positive && probed.converged, relative > 0) << relative;
    EXPECT_EQ(guessed.positive && guessed.converged, relative > 0) << relative;
  }
}

Eigen::VectorXd curve(double p) { return Eigen::Vector3d(1 + p, p * p * p - p, std::pow(p, 5) - 2 * std::pow(p, 4)); }
Eigen::VectorXd slope(double p) { return Eigen::Vector3d(1, 3 * p * p - 1, 5 * std::pow(p, 4) - 8 * std::pow(p, 3)); }

TEST(Predictor, MeetsAQuinticFromThreePoints) {
  Predictor predictor;
  predictor.add(0, curve(0), slope(0));
  EXPECT_LT((predictor.guess(0.5) - (curve(0) + 0.5 * slope(0))).norm(), 1e-14) << "one point: its tangent";
  EXPECT_LT((predictor.slopeGuess(0.5) - slope(0)).norm(), 1e-14);
  predictor.add(0.5, curve(0.5), slope(0.5));
  predictor.add(1, curve(1), slope(1));
  predictor.add(1.5, curve(1.5), slope(1.5));
  EXPECT_LT((predictor.guess(2) - curve(2)).norm(), 1e-12);
  EXPECT_LT((predictor.slopeGuess(2) - slope(2)).norm(), 1e-11);
  // On the way back, the last points lie ahead: only the tangent is left.
  EXPECT_LT((predictor.guess(1.2) - (curve(1.5) - 0.3 * slope(1.5))).norm(), 1e-14);
}

TEST(Predictor, MeetsTheNinthOrderFromFivePoints) {
  Predictor predictor;
  const auto at = [](double p) { return Eigen::VectorXd::Constant(1, std::pow(p, 9) - 3 * std::pow(p, 4)); };
  const auto rise = [](double p) { return Eigen::VectorXd::Constant(1, 9 * std::pow(p, 8) - 12 * std::pow(p, 3)); };
  for (const double p : {0.0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2}) predictor.add(p, at(p), rise(p));
  EXPECT_NEAR(predictor.guess(1.4)(0), at(1.4)(0), 1e-11);
  EXPECT_NEAR(predictor.slopeGuess(1.4)(0), rise(1.4)(0), 1e-9);
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
