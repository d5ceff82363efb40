// Sensitivities against central differences at several steps: small and large strain, both basins.
#include <gtest/gtest.h>

#include "snapwing/statics/arm_problem.h"
#include "snapwing/statics/sensitivity.h"
#include "support/derivative_check.h"

namespace snapwing::statics {
namespace {

/// A small arm on 4 mm cells whose densities vary smoothly.
struct SmallArm {
  SmallArm() {
    common::ArmSettings arm;
    arm.count = 4, arm.domain_length = 0.08, arm.domain_height = 0.04;
    arm.leg_width = arm.bar_height = 0.02, arm.leg_thickness = 0.005, arm.bar_thickness = 0.01;
    arm.pin_x = 0.077, arm.pin_y = 0.003, arm.clamp_y_low = 0.02, arm.clamp_y_high = 0.04;
    const std::string path = std::string(SNAPWING_SOURCE_DIR) + "/data/arms/arris_x220_study.csv";
    mpm::DensityField design = mpm::loadDensityCsv(path, 0.08, 0.04).resampled(0.004);
    for (double& value : design.value) value = value < 0 ? value : 0.15 + 0.8 * value;
    ArmProblemSettings settings;
    problem = std::make_unique<ArmProblem>(arm, elasticity::Material{5.5e6, 0.48, 1210}, design, settings);
    for (int c = 0; c < problem->problem().solid().cellCount(); ++c) {
      density.push_back(problem->problem().solid().cell(c).density);
      direction.push_back(0.5 + 0.5 * std::sin(1.7 * c));
    }
  }

  /// Solves at a travel, reached in steps from 0 at the first call.
  Eigen::VectorXd trace(double travel) {
    std::vector<double> targets;
    for (int k = 0; k <= 40; ++k) targets.push_back(travel * k / 40);
    const PathResult path =
        PathFollower(problem->problem(), {}).follow(Eigen::VectorXd::Zero(problem->problem().freeCount()), targets);
    EXPECT_EQ(path.status, SolveStatus::CONVERGED) << path.message;
    return path.points.back().solution;
  }

  void solveAt(double h, double travel, Eigen::VectorXd z, Evaluation& at, Newton& newton) {
    std::vector<double> moved = density;
    for (std::size_t c = 0; c < moved.size(); ++c) moved[c] += h * direction[c];
    problem->setDensities(moved);
    ASSERT_TRUE(newton.solve(Eigen::VectorXd::Constant(1, travel), z, at).converged());
    problem->setDensities(density);
  }

  double along(const Eigen::VectorXd& by_density) const {
    return by_density.dot(Eigen::Map<const Eigen::VectorXd>(direction.data(), static_cast<int>(direction.size())));
  }

  std::unique_ptr<ArmProblem> problem;
  std::vector<double> density, direction;
};

class SensitivityAt : public ::testing::TestWithParam<double> {};

TEST_P(SensitivityAt, MatchesDifferences) {
  SmallArm arm;
  const double travel = GetParam();
  const Eigen::VectorXd z = arm.trace(travel);
  NewtonSettings settings;
  settings.relative_tolerance = 1e-13;
  Newton newton(arm.problem->problem(), settings);
  Evaluation at;
  arm.solveAt(0, travel, z, at, newton);
  ASSERT_TRUE(newton.cholesky().factorize(at.hessian));
  const Sensitivity<2> adjoint(arm.problem->problem(), newton.cholesky(), at);
  Eigen::MatrixXd weight = Eigen::MatrixXd::Zero(at.displacements.size(), 2);
  for (int k = 0; k < weight.rows(); ++k) weight(k, 0) = std::cos(0.3 * k), weight(k, 1) = k % 2;

  const auto quantity = [&](double h, int which) {
    Evaluation moved;
    Newton fresh(arm.problem->problem(), settings);
    arm.solveAt(h, travel, z, moved, fresh);
    const double all[] = {moved.control_force(0), moved.energy, weight.col(0).dot(moved.displacements),
                          weight.col(1).dot(moved.displacements)};
    return Eigen::VectorXd::Constant(1, all[which]);
  };
  const double expected[] = {arm.along(adjoint.reaction()), arm.along(adjoint.energy()),
                             arm.along(adjoint.displacement(weight.col(0))),
                             arm.along(adjoint.displacement(weight.col(1)))};
  for (int which = 0; which < 4; ++which) {
    EXPECT_TRUE(test::derivativeMatches([&](double h) { return quantity(h, which); },
                                        Eigen::VectorXd::Constant(1, expected[which]), 0.1, 1e-6))
        << "quantity " << which << " at u = " << travel;
  }
}
/// Rest side, past the peak, and the second basin.
INSTANTIATE_TEST_SUITE_P(Travels, SensitivityAt, ::testing::Values(0.002, 0.012, 0.030, 0.060));

TEST(Sensitivity, ReactionHasTheRightSign) {
  // More material everywhere makes the arm stiffer where it is pushed from rest.
  SmallArm arm;
  const Eigen::VectorXd z = arm.trace(0.001);
  Newton newton(arm.problem->problem(), {});
  Evaluation at;
  arm.solveAt(0, 0.001, z, at, newton);
  ASSERT_TRUE(newton.cholesky().factorize(at.hessian));
  EXPECT_GT(Sensitivity<2>(arm.problem->problem(), newton.cholesky(), at).reaction().sum(), 0);
}

}  // namespace
}  // namespace snapwing::statics
