#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <atomic>
#include <random>

#include "serial_regions.h"
#include "snapwing/common/error.h"
#include "snapwing/solver/reduction.h"
#include "snapwing/solver/sparse.h"

/// What `#pragma omp parallel` becomes.
extern "C" void GOMP_parallel(void (*body)(void*), void* data, unsigned threads, unsigned flags);

namespace snapwing::solver {
namespace {

/// Chain of springs with a given diagonal shift.
void chain(int n, double shift, SparsePattern& pattern, std::vector<double>& values, Eigen::MatrixXd& dense) {
  pattern = {};
  values.clear();
  pattern.size = n;
  pattern.start = {0};
  dense = Eigen::MatrixXd::Zero(n, n);
  for (int c = 0; c < n; ++c) {
    pattern.row.push_back(c);
    values.push_back(2 + shift);
    dense(c, c) = 2 + shift;
    if (c + 1 < n) {
      pattern.row.push_back(c + 1);
      values.push_back(-1);
      dense(c + 1, c) = dense(c, c + 1) = -1;
    }
    pattern.start.push_back(static_cast<int>(pattern.row.size()));
  }
}

/// The lower triangle of a matrix, without its zeros.
void lowerTriangle(const Eigen::MatrixXd& dense, SparsePattern& pattern, std::vector<double>& values) {
  const auto n = static_cast<int>(dense.rows());
  pattern = {};
  values.clear();
  pattern.size = n;
  pattern.start = {0};
  for (int c = 0; c < n; ++c) {
    for (int r = c; r < n; ++r) {
      if (dense(r, c) == 0) continue;
      pattern.row.push_back(r);
      values.push_back(dense(r, c));
    }
    pattern.start.push_back(pattern.entries());
  }
}

constexpr int LEFT_TO_CHOLMOD = 3000;  ///< unknowns of a full matrix that the own factor does not take

/// A matrix without zeros: n on the diagonal, and little beside it.
void full(int n, SparsePattern& pattern, std::vector<double>& values) {
  lowerTriangle(Eigen::MatrixXd::NullaryExpr(
                    n, n, [n](Eigen::Index r, Eigen::Index c) -> double { return r == c ? n : std::sin(r + 0.7 * c); }),
                pattern, values);
}

/// Springs between the neighbours of a square grid, diagonals included, each of its own stiffness.
void net(int side, SparsePattern& pattern, std::vector<double>& values, Eigen::MatrixXd& dense) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> stiffness(0.2, 2);
  const int n = side * side;
  dense = 1e-3 * Eigen::MatrixXd::Identity(n, n);
  const auto couple = [&](int a, int b) {
    const double k = stiffness(random);
    dense(a, a) += k, dense(b, b) += k;
    dense(a, b) -= k, dense(b, a) -= k;
  };
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      const int here = j * side + i;
      if (i + 1 < side) couple(here, here + 1);
      if (j + 1 < side) couple(here, here + side);
      if (i + 1 < side && j + 1 < side) couple(here, here + side + 1);
      if (i > 0 && j + 1 < side) couple(here, here + side - 1);
    }
  }
  lowerTriangle(dense, pattern, values);
}

TEST(Cholesky, SolvesNetsOfEverySize) {
  SparsePattern pattern;
  std::vector<double> values;
  Eigen::MatrixXd dense;
  for (const int side : {2, 3, 5, 8, 13, 21, 34}) {
    net(side, pattern, values, dense);
    Cholesky cholesky(pattern);
    ASSERT_TRUE(cholesky.factorize(values));
    const Eigen::MatrixXd right = Eigen::MatrixXd::Random(side * side, 3);
    const Eigen::MatrixXd wanted = dense.llt().solve(right);
    EXPECT_LT((cholesky.solve(right) - wanted).norm(), 1e-11 * wanted.norm()) << side;
    const Eigen::VectorXd first = cholesky.solve(Eigen::VectorXd(right.col(0)));
    EXPECT_EQ(first, cholesky.solve(right).col(0)) << "a right side has the same bits alone";
    EXPECT_LT((pattern.multiply(values, first) - right.col(0)).norm(), 1e-11 * right.col(0).norm()) << side;
    values[pattern.start[side]] -= 20;
    EXPECT_FALSE(cholesky.factorize(values)) << side;
    EXPECT_EQ(cholesky.factorizeIndefinite(values), 1) << side;
  }
}

/// One front of each width: blocks of four columns, what is left of them, and several panels of one supernode.
TEST(Cholesky, SolvesFullFrontsOfEveryWidth) {
  SparsePattern pattern;
  std::vector<double> values;
  for (const int n : {1, 2, 3, 4, 5, 6, 7, 8, 17, 47, 48, 49, 51, 97, 130, 203}) {
    full(n, pattern, values);
    Cholesky cholesky(pattern);
    ASSERT_TRUE(cholesky.factorize(values));
    const Eigen::MatrixXd right = Eigen::MatrixXd::Random(n, 7), found = cholesky.solve(right);
    for (int c = 0; c < right.cols(); ++c) {
      EXPECT_EQ(found.col(c), cholesky.solve(Eigen::VectorXd(right.col(c)))) << "a right side has the same bits alone";
      EXPECT_LT((pattern.multiply(values, found.col(c)) - right.col(c)).norm(), 1e-13 * right.col(c).norm()) << n;
    }
  }
}

/// A preconditioner is one matrix, symmetric and near the inverse; a large factor is rounded for it, a small one is
/// not.
TEST(Cholesky, PreconditionsNearlyAsItSolves) {
  SparsePattern pattern;
  std::vector<double> values;
  for (const int n : {203, 1501}) {
    full(n, pattern, values);
    Cholesky cholesky(pattern);
    for (const double factor : {1.0, 3.0, 0.2}) {  // the second one is rounded as it is made
      for (double& value : values) value *= factor;
      ASSERT_TRUE(cholesky.factorize(values));
      const Eigen::VectorXd a = Eigen::VectorXd::LinSpaced(n, -1, 2), b = Eigen::VectorXd::Random(n);
      const Eigen::VectorXd near = cholesky.precondition(a), exact = cholesky.solve(a);
      const double error = (near - exact).norm() / exact.norm();
      EXPECT_LT(error, 1e-6);
      EXPECT_EQ(error > 1e-10, n > 203) << "rounded";
      EXPECT_NEAR(b.dot(near), a.dot(cholesky.precondition(b)), 1e-12 * exact.norm() * b.norm());
    }
  }
}

TEST(Cholesky, SolvesWhatIsLeftToCholmod) {
  SparsePattern pattern;
  std::vector<double> values;
  full(LEFT_TO_CHOLMOD, pattern, values);
  Cholesky cholesky(pattern);
  ASSERT_TRUE(cholesky.factorize(values));
  const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(LEFT_TO_CHOLMOD, -1, 2);
  EXPECT_LT((pattern.multiply(values, cholesky.solve(right)) - right).norm(), 1e-12 * right.norm());
}

TEST(Cholesky, SolvesAndKnowsDefiniteness) {
  for (const int n : {1, 7, 500}) {
    SparsePattern pattern;
    std::vector<double> values;
    Eigen::MatrixXd dense;
    chain(n, 0, pattern, values, dense);
    Cholesky cholesky(pattern);
    EXPECT_THROW(cholesky.solve(Eigen::VectorXd(Eigen::VectorXd::Ones(n))), common::Error);
    ASSERT_TRUE(cholesky.factorize(values));
    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(n, 1, 2);
    EXPECT_LT((dense * cholesky.solve(b) - b).norm(), 1e-9 * b.norm() * n);
    EXPECT_LT((pattern.multiply(values, b) - dense * b).norm(), 1e-12 * n);
    chain(n, -0.5, pattern, values, dense);
    const int negative = (Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense).eigenvalues().array() < 0).count();
    EXPECT_EQ(cholesky.factorize(values), negative == 0);
    EXPECT_EQ(cholesky.factorizeIndefinite(values), negative);
    EXPECT_LT((dense * cholesky.solve(b) - b).norm(), 1e-7 * b.norm() * n);
    // A good matrix afterwards is factorised as if nothing had happened.
    chain(n, 0.1, pattern, values, dense);
    ASSERT_TRUE(cholesky.factorize(values));
    EXPECT_LT((dense * cholesky.solve(b) - b).norm(), 1e-9 * b.norm() * n);
  }
}

/// CHOLMOD's regions are plain calls, one at least for each factor; elsewhere the thread's regions stay what they are.
TEST(Cholesky, RegionsOfOneThreadAreCalls) {
  SparsePattern pattern;
  std::vector<double> values;
  full(LEFT_TO_CHOLMOD, pattern, values);
  Cholesky cholesky(pattern);
  const long before = SerialRegions::called();
  ASSERT_TRUE(cholesky.factorize(values));
  const long after = SerialRegions::called();
  EXPECT_GT(after, before);
  void (*entry)(void (*)(void*), void*, unsigned, unsigned) = GOMP_parallel;
  std::atomic<int> calls{0};
  const auto count = [](void* data) { ++*static_cast<std::atomic<int>*>(data); };
  entry(count, &calls, 2, 0);
  EXPECT_EQ(calls, 2);
  EXPECT_EQ(SerialRegions::called(), after);
  const SerialRegions serial;
  entry(count, &calls, 2, 0);
  EXPECT_EQ(calls, 3);
  EXPECT_EQ(SerialRegions::called(), after + 1);
}

TEST(Reduction, EliminatesChainedEquations) {
  // u0 = p; u1 + u2 = 0; u2 = u3 + 1; the last repeats the first two.
  const std::vector<Equation> equations = {{{{0, 1.0}}, {{0, 1.0}}, 0, "drive"},
                                           {{{1, 1.0}, {2, 1.0}}, {}, 0, "pair"},
                                           {{{2, 1.0}, {3, -1.0}}, {}, 1, "offset"},
                                           {{{0, 2.0}, {1, 1.0}, {2, 1.0}}, {{0, 2.0}}, 0, "again"}};
  const Reduction r(5, 1, equations);
  EXPECT_EQ(r.freeCount(), 2);
  ASSERT_EQ(r.redundant().size(), 1u);
  EXPECT_EQ(r.redundant()[0], "again");
  const Eigen::VectorXd u = r.expand(Eigen::Vector2d(0.3, -2), Eigen::VectorXd::Constant(1, 7));
  for (const Equation& e : equations) {
    double left = 0, right = e.constant;
    for (const auto& [dof, value] : e.terms) left += value * u(dof);
    for (const auto& [k, value] : e.control) right += value * 7;
    EXPECT_NEAR(left, right, 1e-14) << e.name;
  }
  EXPECT_TRUE(r.expand(r.freePart(u), Eigen::VectorXd::Constant(1, 7)).isApprox(u));
  // Restriction is the transpose of expansion.
  const Eigen::VectorXd f = Eigen::VectorXd::LinSpaced(5, 1, 3), dz = Eigen::Vector2d(0.2, 5),
                        dp = Eigen::VectorXd::Constant(1, -3);
  EXPECT_NEAR(f.dot(r.expandDirection(dz, dp)), r.restrictToFree(f).dot(dz) + r.restrictToControl(f).dot(dp), 1e-12);
}

TEST(Reduction, RefusesContradictions) {
  const Equation held{{{0, 1.0}}, {}, 0, "wall"};
  EXPECT_THROW(Reduction(2, 1, {held, {{{0, 1.0}}, {{0, 1.0}}, 0, "port"}}), common::Error);
  EXPECT_THROW(Reduction(2, 1, {held, {{{0, 2.0}}, {}, 1e-3, "other wall"}}), common::Error);
  EXPECT_NO_THROW(Reduction(2, 1, {held, held}));
}

}  // namespace
}  // namespace snapwing::solver
