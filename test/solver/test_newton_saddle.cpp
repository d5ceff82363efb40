// Where no energy decides, Newton's method finds a stationary point whatever the inertia of its tangent.
#include <gtest/gtest.h>

#include <cmath>

#include "snapwing/solver/equilibrium.h"

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

/// The same beside a third coordinate on a curve, z2 = z0 + d z1^2, whose constraint bears a force: the stationary
/// point is still 0, and a saddle on the curve.
class SaddleOnACurve : public Problem {
 public:
  static constexpr double A = 30, B = 4, C = 20, K = 15, D = 3, FORCE = 0.7, PENALTY = 2;
  explicit SaddleOnACurve(bool potential) : potential_(potential) {
    pattern_.size = 3;
    pattern_.start = {0, 3, 5, 6};
    pattern_.row = {0, 1, 2, 1, 2, 2};
    LinearRows rows;
    rows.rows.resize(1, 3);
    rows.control.resize(1, 0);
    rows.constant = Eigen::VectorXd::Zero(1);
    rows.names = {"curve"};
    rows.equation = {0};
    constraints_ = std::make_unique<const Constraints>(rows, Enforcement::MULTIPLIERS, PENALTY, 1e-12);
  }
  const Constraints* constraints() const override { return constraints_.get(); }
  bool curvedConstraints() const override { return true; }
  int freeCount() const override { return 3; }
  int controlCount() const override { return 0; }
  const SparsePattern& pattern() const override { return pattern_; }
  void evaluate(const Eigen::VectorXd& z, const Eigen::VectorXd& p, Order order, Evaluation& out) const override {
    evaluateLagrangian(z, p, Eigen::VectorXd::Zero(1), order, out);
  }
  void evaluateLagrangian(const Eigen::VectorXd& z, const Eigen::VectorXd&, const Eigen::VectorXd& multipliers,
                          Order order, Evaluation& out) const override {
    const double gap = z(2) - z(0) - D * z(1) * z(1), bears = multipliers(0) + PENALTY * gap;
    const Eigen::Vector3d row(-1, -2 * D * z(1), 1);
    out.energy = 0.5 * A * z(0) * z(0) - 0.5 * B * z(1) * z(1) + C * z(0) * z(1) * z(1) + 0.5 * K * z(2) * z(2) +
                 FORCE * (z(0) - z(2)) + multipliers(0) * gap + 0.5 * PENALTY * gap * gap;
    out.elastic_energy = out.energy;
    out.residual =
        Eigen::Vector3d(A * z(0) + C * z(1) * z(1) + FORCE, -B * z(1) + 2 * C * z(0) * z(1), K * z(2) - FORCE) +
        bears * row;
    const double across = 2 * C * z(1), along = -B + 2 * C * z(0) - 2 * D * bears;
    Eigen::Matrix3d h = PENALTY * row * row.transpose();
    h.diagonal() += Eigen::Vector3d(A, order == Order::PROJECTED ? std::abs(along) : along, K);
    if (order != Order::PROJECTED) h(1, 0) += across;
    out.hessian = {h(0, 0), h(1, 0), h(2, 0), h(1, 1), h(2, 1), h(2, 2)};
    out.force_scale = 1;
    out.finite = true;
    out.potential = potential_;
    out.constraint_residual = Eigen::VectorXd::Constant(1, gap);
    auto rows = std::make_shared<ConstraintRows>(1, 3);
    for (int k = 0; k < 3; ++k) rows->insert(0, k) = row(k);
    out.rows = rows;
  }
  void controlTangent(const Evaluation&, const Eigen::VectorXd&, Eigen::VectorXd&, Eigen::VectorXd&) const override {}
  double forceFloor() const override { return 0; }
  std::string describeCell(int) const override { return "none"; }

 private:
  bool potential_;
  SparsePattern pattern_;
  std::unique_ptr<const Constraints> constraints_;
};

struct Found {
  NewtonResult result;
  Equilibrium x;
};

Found foundOnTheCurve(bool potential, Projection projection) {
  const SaddleOnACurve problem(potential);
  NewtonSettings settings;
  settings.projection = projection;
  EquilibriumSolver solver(problem, settings);
  Found out;
  out.x = solver.start(Eigen::Vector3d(0.03, 0.02, 0.05), 0);  // not on the curve
  out.result = solver.minimise(out.x);
  return out;
}

TEST(NewtonSaddle, OnAConstraintItIsFoundWhereTheResidualDecides) {
  const Found found = foundOnTheCurve(false, Projection::ON_DEMAND);
  EXPECT_TRUE(found.result.converged()) << found.result.message;
  EXPECT_LT(found.x.z.norm(), 1e-8);
  EXPECT_NEAR(found.x.multipliers(0), SaddleOnACurve::FORCE, 1e-8);
  EXPECT_LE(found.result.iterations, 6) << "quadratic";
  EXPECT_EQ(found.result.projections, 0);
}

/// Why it takes its own direction there: that of the projected tangent leads away from the saddle and raises the
/// residual.
TEST(NewtonSaddle, OnAConstraintAProjectedTangentDoesNotFindIt) {
  const Found found = foundOnTheCurve(false, Projection::ALWAYS);
  EXPECT_FALSE(found.result.converged());
  EXPECT_GT(std::abs(found.x.z(1)), 1e-3);
}

TEST(NewtonSaddle, OnAConstraintItIsLeftWhereTheEnergyDecides) {
  const Found found = foundOnTheCurve(true, Projection::ON_DEMAND);
  EXPECT_GT(std::abs(found.x.z(1)), 0.02);
}

}  // namespace
}  // namespace snapwing::solver
