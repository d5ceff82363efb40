// Where no energy decides, Newton's method finds a stationary point whatever the inertia of its tangent.
#include <gtest/gtest.h>

#include <cmath>

#include "snapwing/solver/newton.h"

namespace snapwing::solver {
namespace {

/// E = a z0^2 / 2 - b z1^2 / 2 + c z0 z1^2: a saddle at 0. `potential` says whether its energy may decide.
class Saddle : public Problem {
 public:
  explicit Saddle(bool potential) : potential_(potential) {
    pattern_.size = 2;
    pattern_.start = {0, 2, 3};
    pattern_.row = {0, 1, 1};
  }
  int freeCount() const override { return 2; }
  int controlCount() const override { return 0; }
  const SparsePattern& pattern() const override { return pattern_; }
  void evaluate(const Eigen::VectorXd& z, const Eigen::VectorXd&, Order order, Evaluation& out) const override {
    constexpr double A = 30, B = 4, C = 20;
    out.energy = out.elastic_energy = 0.5 * A * z(0) * z(0) - 0.5 * B * z(1) * z(1) + C * z(0) * z(1) * z(1);
    out.residual = Eigen::Vector2d(A * z(0) + C * z(1) * z(1), -B * z(1) + 2 * C * z(0) * z(1));
    const double across = 2 * C * z(1), along = -B + 2 * C * z(0);
    const bool projected = order == Order::PROJECTED;  // without the negative part, as a particle's tangent
    out.hessian = projected ? std::vector<double>{A, 0, std::abs(along)} : std::vector<double>{A, across, along};
    out.force_scale = 1;
    out.finite = true;
    out.potential = potential_;
  }
  void controlTangent(const Evaluation&, const Eigen::VectorXd&, Eigen::VectorXd&, Eigen::VectorXd&) const override {}
  double forceFloor() const override { return 0; }
  std::string describeCell(int) const override { return "none"; }

 private:
  bool potential_;
  SparsePattern pattern_;
};

TEST(NewtonSaddle, IsFoundWhereTheResidualDecides) {
  const Saddle problem(false);
  Newton newton(problem, {});
  Eigen::VectorXd z = Eigen::Vector2d(0.03, 0.02);
  Evaluation at;
  const NewtonResult result = newton.solve(Eigen::VectorXd(), z, at);
  EXPECT_TRUE(result.converged()) << result.message;
  EXPECT_LT(z.norm(), 1e-6);
  EXPECT_LE(result.iterations, 6) << "quadratic";
}

TEST(NewtonSaddle, IsLeftWhereTheEnergyDecides) {
  const Saddle problem(true);
  Newton newton(problem, {});
  Eigen::VectorXd z = Eigen::Vector2d(0.03, 0.02);
  Evaluation at;
  newton.solve(Eigen::VectorXd(), z, at);
  EXPECT_GT(std::abs(z(1)), 0.02);
}

}  // namespace
}  // namespace snapwing::solver
