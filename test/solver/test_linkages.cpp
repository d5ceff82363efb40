// Rigid bodies in pins and closed chains: the term and its derivatives, and what is redundant. In time:
// test/motion/test_linkages_in_time.cpp.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <functional>

#include "linkage.h"
#include "snapwing/common/error.h"
#include "support/term_check.h"

namespace snapwing::solver {
namespace {

using testing_linkages::Bar;
using testing_linkages::FourBar;
using testing_linkages::Linkage;
using testing_linkages::makeLinkage;
using testing_linkages::PENDULUM;
using testing_linkages::Pin;

/// Residual, Hessian and rows of a problem with constraints against differences, at multipliers that are not zero.
void checkLagrangian(const Problem& problem, const Eigen::VectorXd& z, double scale) {
  const int count = problem.constraints()->count();
  Eigen::VectorXd lambda(count), d(z.size());
  for (int k = 0; k < count; ++k) lambda(k) = 0.7 * std::cos(1.3 * k);
  for (int k = 0; k < z.size(); ++k) d(k) = std::sin(2.1 * k + 1);
  const Eigen::VectorXd p = Eigen::VectorXd::Zero(problem.controlCount());
  Evaluation at, other;
  problem.evaluateLagrangian(z, p, lambda, Order::TANGENT, at);
  const auto energy = [&](double h) {
    problem.evaluateLagrangian(z + h * d, p, lambda, Order::ENERGY, other);
    return Eigen::VectorXd::Constant(1, other.energy);
  };
  const auto residual = [&](double h) {
    problem.evaluateLagrangian(z + h * d, p, lambda, Order::STRESS, other);
    return other.residual;
  };
  const auto gap = [&](double h) {
    problem.evaluateLagrangian(z + h * d, p, lambda, Order::ENERGY, other);
    return other.constraint_residual;
  };
  EXPECT_GT(at.constraint_residual.norm(), 1e-4) << "away from where they hold";
  EXPECT_TRUE(test::derivativeMatches(energy, Eigen::VectorXd::Constant(1, at.residual.dot(d)), scale, 1e-8));
  EXPECT_TRUE(test::derivativeMatches(residual, problem.pattern().multiply(at.hessian, d), scale, 1e-8));
  EXPECT_TRUE(test::derivativeMatches(gap, *at.rows * d, scale, 1e-8));
}

TEST(Linkage, LagrangianHasItsDerivativesAwayFromItsConstraints) {
  const FourBar four;
  for (const bool keep : {false, true}) {
    const Linkage linkage = makeLinkage(four.bars(0.8), four.pins(0.8), keep);
    ASSERT_NE(linkage.problem->constraints(), nullptr);
    Eigen::VectorXd alone = Eigen::VectorXd::Zero(linkage.problem->freeCount());
    Evaluation never;
    EXPECT_THROW(Newton(*linkage.problem, {}).solve(Eigen::VectorXd(), alone, never), common::Error);
    EXPECT_EQ(linkage.problem->constraints()->count(), keep ? 8 : 2);
    EXPECT_EQ(linkage.redundant, 0);
    Eigen::VectorXd z(linkage.problem->freeCount());
    for (int k = 0; k < z.size(); ++k) z(k) = 0.02 * std::sin(1.7 * k + 0.2);
    checkLagrangian(*linkage.problem, z, 0.01);
  }
}

TEST(ConstraintTerm, IsATerm) {
  LinearRows rows;
  rows.rows.resize(2, 6);
  rows.rows.insert(0, 1) = 2;
  rows.rows.insert(0, 4) = -1;
  rows.rows.insert(1, 0) = 0.5;
  rows.control = Eigen::MatrixXd::Constant(2, 2, 0.3);
  rows.control(1, 0) = -2;
  rows.constant = Eigen::Vector2d(1e-3, 0);
  rows.names = {"a", "b"};
  rows.equation = {0, 1};
  test::TermCase c{HessianLayout(6), {Eigen::VectorXd::LinSpaced(6, -1e-3, 2e-3)}};
  c.p = Eigen::Vector2d(0.3, -2);
  c.energy_depends_on_control = true;
  checkTerm(ConstraintTerm(std::make_shared<const Constraints>(rows, Enforcement::MULTIPLIERS, 300, 1e-12)), c);
  EXPECT_THROW(Constraints(rows, Enforcement::AUGMENTED_LAGRANGIAN, 0, 1e-12), common::Error);
  EXPECT_THROW(Constraints(rows, Enforcement::ELIMINATION, 1, 1e-12), common::Error);
  EXPECT_THROW(Constraints(rows, Enforcement::MULTIPLIERS, 1, 0), common::Error);
  rows.names.pop_back();
  EXPECT_THROW(Constraints(rows, Enforcement::MULTIPLIERS, 1, 1e-12), common::Error);
}

/// Two bars in two pins are one body: of the equations that turn them alike one follows from the other.
TEST(Linkage, RedundantPinsAreCounted) {
  const std::vector<Bar> bars = {{{0, 0}, {0.1, 0}}, {{0, 0}, {0.1, 0}}};
  const std::vector<Pin> pins = {{"left", 0, 1, {0, 0}}, {"right", 0, 1, {0.1, 0}}, {"wall", 0, -1, {0, 0}}};
  EXPECT_EQ(makeLinkage(bars, pins, false).redundant, 1);
  EXPECT_EQ(makeLinkage(bars, pins, true).redundant, 1);
}

/// Of a triangle of pinned bars nothing moves, and pins of another length apart cannot hold at all.
TEST(Linkage, WhatCannotHoldTogetherIsRefusedByName) {
  const FourBar four;
  std::vector<Pin> pins = four.pins(0.8);
  pins.push_back({"nail", 1, -1, four.bars(0.8)[1].centre()});
  EXPECT_EQ(makeLinkage(four.bars(0.8), pins, false).redundant, 1) << "it holds what could move, and once more";
  LinearRows apart;
  apart.rows.resize(2, 12);
  apart.rows.insert(0, 4) = apart.rows.insert(1, 5) = 1;
  apart.control = Eigen::MatrixXd::Zero(2, 0);
  apart.constant = Eigen::Vector2d(0.03, 0.03);  // E of one angle cannot be so
  apart.names = {"first", "second"};
  apart.equation = {0, 1};
  const Linkage free = makeLinkage({PENDULUM[0], PENDULUM[1]}, {}, false);
  try {
    redundantRows(free.problem->coordinates(), apart, 1e-4);
    FAIL() << "accepted";
  } catch (const common::Error& e) {
    EXPECT_NE(std::string(e.what()).find("'first'"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("contradict each other"), std::string::npos) << e.what();
  }
}

/// A path of two controls on a line, and a problem without any.
TEST(ControlLine, LeadsSeveralControlsTogether) {
  LinearRows rows;
  rows.rows.resize(2, 2);
  rows.rows.insert(0, 0) = rows.rows.insert(1, 1) = 1;
  rows.control = Eigen::MatrixXd::Identity(2, 2);
  rows.constant = Eigen::VectorXd::Zero(2);
  rows.names = {"x", "y"};
  rows.equation = {0, 1};
  /// k/2 (y0 + 2 y1)^2
  class Spring : public Term {
   public:
    std::string name() const override { return "spring"; }
    Role role() const override { return Role::STORED; }
    std::vector<std::vector<int>> couples() const override { return {{0, 1}}; }
    void evaluate(const Point& at, Order order, Sum& sum) const override {
      const Eigen::Vector2d row(1, 2);
      const double stretch = row.dot(at.y);
      sum.energy += 50 * stretch * stretch;
      sum.stored += 50 * stretch * stretch;
      if (order == Order::ENERGY) return;
      sum.gradient += 100 * stretch * row;
      sum.noteForce(100 * std::abs(stretch));
      if (elasticity::withTangent(order)) sum.addRankOne(0, 100, row);
    }
  };
  TermProblem::Parts parts{HessianLayout(2),
                           std::make_shared<const Coordinates>(Reduction(2, 2, {}), 2),
                           {std::make_shared<const Spring>()},
                           1,
                           1e-12,
                           0};
  parts.constraints = std::make_shared<const Constraints>(rows, Enforcement::MULTIPLIERS, 1000, 1e-12);
  const TermProblem problem(std::move(parts));
  EXPECT_THROW(EquilibriumSolver(problem, {}), common::Error);
  EquilibriumSolver solver(problem, {}, {Eigen::Vector2d(0.1, 0), Eigen::Vector2d(3, -1)});
  Equilibrium x = solver.start(Eigen::VectorXd::Zero(2), 0.2);
  ASSERT_TRUE(solver.minimise(x).converged());
  solver.linearise(x);
  // At (0.7, -0.2) stretched by 0.3, which grows by 1 per t.
  EXPECT_NEAR(x.z(0), 0.7, 1e-12);
  EXPECT_NEAR(x.force(), 100 * 0.3 * 1, 1e-9);
  EXPECT_NEAR(x.stiffness, 100, 1e-8);
  EXPECT_EQ(x.negative_pivots, 0);
}

}  // namespace
}  // namespace snapwing::solver
