// Rigid bodies and cylinders: derivatives at finite rotation, closed forms, refusals.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <random>

#include "scene_text.h"
#include "snapwing/common/error.h"
#include "snapwing/solver/rotation.h"
#include "support/derivative_check.h"

namespace snapwing::scene {
namespace {

template <int D>
Eigen::Matrix<double, D, D> rotationOf(const solver::Rotation& t, const Eigen::VectorXd& s,
                                       const Eigen::Matrix3d* reference = nullptr) {
  const Eigen::VectorXd e = solver::rotate(t, D, s, reference).value / t.length;
  return Eigen::Map<const Eigen::Matrix<double, D, D>>(e.data()) + Eigen::Matrix<double, D, D>::Identity();
}

template <int D>
void checkRotation(const solver::Rotation& t, const Eigen::VectorXd& s, const Eigen::Matrix3d* reference = nullptr) {
  const auto r = rotationOf<D>(t, s, reference);
  EXPECT_LT((r.transpose() * r - Eigen::MatrixXd::Identity(D, D)).norm(), 1e-13);
  EXPECT_NEAR(r.determinant(), 1, 1e-13);
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const Eigen::VectorXd d = Eigen::VectorXd::NullaryExpr(s.size(), [&] { return normal(random); });
  const solver::RotationValue at = solver::rotate(t, D, s, reference);
  EXPECT_TRUE(test::derivativeMatches([&](double h) { return solver::rotate(t, D, s + h * d, reference).value; },
                                      at.slope * d, t.length, 1e-9));
  Eigen::VectorXd second(D * D * s.size());
  for (int e = 0; e < D * D; ++e) second.segment(e * s.size(), s.size()) = at.second[e] * d;
  const auto slopes = [&](double h) {
    const Eigen::MatrixXd slope = solver::rotate(t, D, s + h * d, reference).slope.transpose();
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(slope.data(), slope.size()));
  };
  EXPECT_TRUE(test::derivativeMatches(slopes, second, t.length, 1e-8));
}

TEST(Rotation, IsARotationWithItsDerivatives) {
  using Eigen::Vector3d;
  const solver::Rotation planar{0, 0.02, {Vector3d::UnitZ()}};
  for (const double angle : {0.0, 0.3, -2.0, 5.0}) checkRotation<2>(planar, Eigen::VectorXd::Constant(1, 0.02 * angle));
  const solver::Rotation axis{0, 0.02, {Vector3d(1, 2, -2) / 3}};
  checkRotation<3>(axis, Eigen::VectorXd::Constant(1, 0.02 * 1.3));
  const solver::Rotation all{0, 0.02, {Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()}};
  for (const Vector3d& v : {Vector3d(0, 0, 0), Vector3d(1e-5, 0, 0), Vector3d(0.4, -0.9, 1.1), Vector3d(3, 4, -1)}) {
    checkRotation<3>(all, 0.02 * v);
  }
}

TEST(Rotation, FromAReferenceIsTheProduct) {
  using Eigen::Vector3d;
  const Eigen::Matrix3d reference = Eigen::AngleAxisd(2.5, Vector3d(2, -1, 2) / 3).toRotationMatrix();
  const Eigen::Matrix3d in_plane = Eigen::AngleAxisd(-1.9, Vector3d::UnitZ()).toRotationMatrix();
  const solver::Rotation planar{0, 0.02, {Vector3d::UnitZ()}};
  checkRotation<2>(planar, Eigen::VectorXd::Constant(1, 0.02 * 0.7), &in_plane);
  const solver::Rotation all{0, 0.02, {Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()}};
  const Eigen::VectorXd s = 0.02 * Vector3d(0.4, -0.9, 1.1);
  checkRotation<3>(all, s, &reference);
  EXPECT_LT((rotationOf<3>(all, s, &reference) - rotationOf<3>(all, s) * reference).norm(), 1e-14);
}

TEST(Rotation, QuarterTurnAboutZ) {
  const double quarter = std::acos(0.0);
  const solver::Rotation all{0, 1, {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()}};
  const Eigen::Matrix3d r = rotationOf<3>(all, Eigen::Vector3d(0, 0, quarter));
  EXPECT_LT((r * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-14);
}

/// A flexible strip, clamped at the left, with a rigid block at its right end: joined at two points, loaded on its far
/// face.
std::string stripAndBlock(int dimension, const std::string& kernel, const std::string& more) {
  const std::string plane = dimension == 2 ? "plane: strain\n" : "";
  const std::string joints =
      dimension == 2 ? "joints:\n  - {name: low, first: strip, second: block, at: [6, 0]}\n"
                       "  - {name: high, first: strip, second: block, at: [6, 1]}\n"
                     : "joints:\n  - {name: low, first: strip, second: block, at: [6, 0]}\n"
                       "  - {name: high, first: strip, second: block, from: [6, 1, -0.9], to: [6, 1, 0.9]}\n";
  return "scene: strip\nlength_unit: mm\ndimension: " + std::to_string(dimension) + "\n" + plane + "kernel: " + kernel +
         "\ncell_size: 1\nuse_symmetry: false\nbodies:\n"
         "  strip:\n    material: {youngs_modulus: 5.5e+6, poisson_ratio: 0.3}\n    thickness: 2\n"
         "    shape: {box: {x: [0, 6], y: [0, 1]}}\n"
         "  block:\n    material: {rigid: true, mass_density: 2000}\n    thickness: 2\n"
         "    shape: {box: {x: [6, 10], y: [0, 1]}}\n" +
         joints +
         "supports:\n  - {name: wall, body: strip, region: {x: [0, 0]}, hold: " + (dimension == 2 ? "xy" : "xyz") +
         "}\n" + more + "path: {to: 1, steps: 8}\n";
}

/// Residual and Hessian of the problem with finite rotations against differences of energy and residual.
void checkProblem(const solver::Problem& problem, const Eigen::VectorXd& z, double p, double scale) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const Eigen::VectorXd d = Eigen::VectorXd::NullaryExpr(z.size(), [&] { return normal(random); }).normalized();
  const Eigen::VectorXd control = Eigen::VectorXd::Constant(1, p);
  solver::Evaluation at, other;
  problem.evaluate(z, control, solver::Order::TANGENT, at);
  ASSERT_TRUE(at.finite);
  const auto energy = [&](double h) {
    problem.evaluate(z + h * d, control, solver::Order::ENERGY, other);
    return Eigen::VectorXd::Constant(1, other.energy);
  };
  const auto residual = [&](double h) {
    problem.evaluate(z + h * d, control, solver::Order::STRESS, other);
    return other.residual;
  };
  EXPECT_TRUE(test::derivativeMatches(energy, Eigen::VectorXd::Constant(1, at.residual.dot(d)), scale, 1e-6));
  EXPECT_TRUE(test::derivativeMatches(residual, problem.pattern().multiply(at.hessian, d), scale, 1e-7));
  Eigen::VectorXd free_part, control_part;
  problem.controlTangent(at, Eigen::VectorXd::Ones(1), free_part, control_part);
  if (free_part.norm() == 0) return;
  const auto by_control = [&](double h) {
    problem.evaluate(z, Eigen::VectorXd::Constant(1, p + h), solver::Order::STRESS, other);
    return other.residual;
  };
  EXPECT_TRUE(test::derivativeMatches(by_control, free_part, std::max(1e-3, std::abs(p)), 1e-7));
}

const char* const END_LOAD_2 = "loads:\n  - {name: end, body: block, region: {x: [10, 10]}, force: [0, 0.12]}\n";
const char* const END_LOAD_3 = "loads:\n  - {name: end, body: block, region: {x: [10, 10]}, force: [0, 0.12, 0.03]}\n";

/// The same in a step in time, with a rotation that goes on from a reference; and the inertia is that of the masses.
TEST(Rigid, StepsHaveTheirTangentAtFiniteRotation) {
  for (const int dimension : {2, 3}) {
    const Scene scene = sceneFromText(stripAndBlock(dimension, "linear", dimension == 2 ? END_LOAD_2 : END_LOAD_3));
    const auto compiled = compileScene(scene, 1);
    const auto problem = compiled->sharedTerms()->with({compiled->inertia(mpm::MassKind::CONSISTENT)});
    const solver::Coordinates& coordinates = problem->coordinates();
    ASSERT_EQ(coordinates.rotationCount(), 1);
    const Eigen::VectorXd p = Eigen::VectorXd::Zero(1);
    auto context = std::make_shared<solver::StepContext>();
    context->step.h = 1e-3;
    context->step.kappa = 2e6;
    context->step.path = {{0.5, 1.0}};
    Eigen::VectorXd z(problem->freeCount());
    for (int k = 0; k < z.size(); ++k) z(k) = 3e-5 * std::sin(1.1 * k);
    for (int k = 1; k <= (dimension == 2 ? 1 : 3); ++k) z(z.size() - k) = 2e-4 * k;
    const std::shared_ptr<const solver::References> reference = coordinates.renew(z, nullptr);
    context->step.y0 = coordinates.expand(z, p, reference.get());
    context->step.v0 = Eigen::VectorXd::Zero(coordinates.fullCount());
    for (int k = 0; k < z.size(); ++k) z(k) += 2e-5 * std::cos(2.3 * k);
    checkProblem(solver::StepProblem(problem, context, reference), z, 0, 1e-5);
    // All nodes moved alike by d at rest: kappa / 2 m d^2.
    context->step.path.clear();
    context->step.y0 = Eigen::VectorXd::Zero(coordinates.fullCount());
    solver::HessianLayout layout(coordinates.fullCount());
    const int nodes = compiled->planar() ? compiled->planar()->dofCount() : compiled->volumetric()->dofCount();
    dimension == 2 ? layout.addRegion(0, compiled->planar()->pattern())
                   : layout.addRegion(0, compiled->volumetric()->pattern());
    Eigen::VectorXd y = Eigen::VectorXd::Zero(coordinates.fullCount());
    for (int k = 0; k < nodes; k += dimension) y(k) = 1e-3;
    solver::Sum sum;
    sum.reset(layout, 1, solver::Order::ENERGY);
    compiled->inertia(mpm::MassKind::CONSISTENT)->evaluate({y, p, &context->step, 1}, solver::Order::ENERGY, sum);
    const double mass = compiled->movingMass(0 * z, 0, 0 * z).mass / compiled->multiplicity();
    EXPECT_GT(mass, 1e-6);
    EXPECT_NEAR(sum.energy, 0.5 * 2e6 * mass * 1e-6, 1e-12 * sum.energy);
  }
}

TEST(Rigid, EnergyResidualAndTangentAgreeAtFiniteRotation) {
  for (const int dimension : {2, 3}) {
    const Scene scene = sceneFromText(stripAndBlock(dimension, "linear", dimension == 2 ? END_LOAD_2 : END_LOAD_3));
    const auto compiled = compileScene(scene, 1);
    const statics::SceneCurve curve = statics::traceScene(scene, *compiled, {}, {});
    ASSERT_EQ(curve.path.status, solver::SolveStatus::CONVERGED) << curve.path.message;
    Eigen::VectorXd z = curve.path.points.back().solution;
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    for (double& value : z) value += 2e-5 * normal(random);
    checkProblem(compiled->problem(), z, 0.7, 1e-3);
  }
}

/// The block turns far, stays undeformed, and carries its loads: distances and the moment's lever are exact.
TEST(Rigid, BodyMovesRigidly) {
  for (const int dimension : {2, 3}) {
    for (const std::string kernel : {"linear", "quadratic"}) {
      const std::string zero = dimension == 2 ? "" : ", 0";
      const std::string monitors =
          "monitors:\n  - {name: ax, body: block, at: [6.3, 0.2" + zero + "], direction: [1, 0" + zero + "]}\n" +
          "  - {name: ay, body: block, at: [6.3, 0.2" + zero + "], direction: [0, 1" + zero + "]}\n" +
          "  - {name: bx, body: block, at: [9.7, 0.9" + zero + "], direction: [1, 0" + zero + "]}\n" +
          "  - {name: by, body: block, at: [9.7, 0.9" + zero + "], direction: [0, 1" + zero + "]}\n" +
          "  - {name: turn, body: block, at: [8, 0.5" + zero + "], radius: 3}\n";
      const std::string load =
          dimension == 2 ? END_LOAD_2
                         : "loads:\n  - {name: end, body: block, region: {x: [10, 10]}, force: [0, 0.12, 0]}\n";
      const statics::SceneCurve curve = trace(sceneFromText(stripAndBlock(dimension, kernel, load + monitors)));
      ASSERT_EQ(curve.path.status, solver::SolveStatus::CONVERGED) << curve.path.message;
      const std::vector<double>& m = curve.monitors.back();
      const Eigen::Vector2d a(6.3e-3, 0.2e-3), b(9.7e-3, 0.9e-3), rest = b - a;
      const Eigen::Vector2d now = rest + Eigen::Vector2d(m[2] - m[0], m[3] - m[1]);
      EXPECT_GT(m[4], 0.3) << "the case must turn far";
      EXPECT_NEAR(now.norm(), rest.norm(), 1e-12);
      EXPECT_NEAR(std::atan2(rest(0) * now(1) - rest(1) * now(0), rest.dot(now)), m[4], 1e-9);
      EXPECT_LT(curve.path.iterations, 9 * 8) << "Newton's tangent is true";
    }
  }
}

/// A hundred times the modulus must bring the error to a hundredth.
TEST(Rigid, EqualsAVeryStiffBodyInTheLimit) {
  const std::string text = stripAndBlock(2, "linear", END_LOAD_2);
  const statics::SceneCurve rigid = trace(sceneFromText(text));
  double last = 1e9;
  for (const std::string modulus : {"5.5e+8", "5.5e+10"}) {
    std::string soft = text;
    const std::string from = "{rigid: true, mass_density: 2000}";
    soft.replace(soft.find(from), from.size(), "{youngs_modulus: " + modulus + ", poisson_ratio: 0.3}");
    const statics::SceneCurve stiff = trace(sceneFromText(soft));
    ASSERT_EQ(stiff.path.status, solver::SolveStatus::CONVERGED) << stiff.path.message;
    const double error = std::abs(stiff.path.points.back().force / rigid.path.points.back().force - 1);
    EXPECT_LT(error, 0.05 * last);
    last = error;
  }
  EXPECT_LT(last, 1e-3);
}

/// What lifts the block carries its weight, whatever the strip does.
TEST(Rigid, GravityOfARigidBodyIsItsWeight) {
  const std::string text = stripAndBlock(2, "linear",
                                         "gravity: [0, -9.81]\nports:\n  - {name: lift, body: block, region: {y: [0, "
                                         "0]}, direction: [0, 1], cross_motion: held}\n");
  const statics::SceneCurve curve = trace(sceneFromText(text));
  ASSERT_EQ(curve.path.status, solver::SolveStatus::CONVERGED) << curve.path.message;
  const double weight = 2000 * 9.81 * 4e-3 * 1e-3 * 2e-3;
  const statics::SceneCurve light = trace(sceneFromText(stripAndBlock(
      2, "linear",
      "ports:\n  - {name: lift, body: block, region: {y: [0, 0]}, direction: [0, 1], cross_motion: held}\n")));
  for (std::size_t k = 0; k < curve.path.points.size(); ++k) {
    EXPECT_NEAR(curve.path.points[k].force - light.path.points[k].force, weight, 1e-9 * weight + 1e-12);
  }
}

/// Held so that it may turn about one skew axis only: the axis is found.
TEST(Rigid, OpenAxesAreFoundOrRefused) {
  const solver::Rotation t{100, 1, {}};
  using Eigen::Vector3d;
  const std::vector<Vector3d> all = {Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()};
  const auto entry = [](int i, int j, double value) { return std::make_pair(100 + i + 3 * j, value); };
  EXPECT_EQ(solver::openAxes<3>(t, {}, all, "b").size(), 3u);
  // E (1, 1, 0) = 0: the axis (1, 1, 0).
  std::vector<solver::Equation> held;
  for (int i = 0; i < 3; ++i) held.push_back({{entry(i, 0, 1), entry(i, 1, 1)}, {}, 0, "rod"});
  const std::vector<Vector3d> axis = solver::openAxes<3>(t, held, all, "b");
  ASSERT_EQ(axis.size(), 1u);
  EXPECT_LT(axis[0].cross(Vector3d(1, 1, 0).normalized()).norm(), 1e-12);
  // All columns held: no turning.
  held.clear();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) held.push_back({{entry(i, j, 1)}, {}, 0, "glue"});
  }
  EXPECT_TRUE(solver::openAxes<3>(t, held, all, "b").empty());
  // One entry alone leaves a surface, or holds at second order only: neither is told as an axis.
  EXPECT_THROW(solver::openAxes<3>(t, {{{entry(0, 1, 1)}, {}, 0, "slot"}}, all, "b"), common::Error);
  EXPECT_THROW(solver::openAxes<3>(t, {{{entry(0, 0, 1)}, {}, 0, "slot"}}, all, "b"), common::Error);
}

TEST(Rigid, WhatCannotBeToldIsRefused) {
  const std::string turned = stripAndBlock(2, "linear",
                                           "pins:\n  - {name: nail, body: block, at: [8, 0.5], kind: line}\n"
                                           "ports:\n  - {name: push, body: block, region: {x: [10, 10], y: [0, 0]}, "
                                           "direction: [0, 1], cross_motion: held}\n");
  EXPECT_NE(reasonFor(turned).find("'nail' contradict each other"), std::string::npos) << reasonFor(turned);
  const std::string pin = box("linear", 2,
                              "pins:\n  - {name: axle, at: [1, 1], kind: cylinder, radius: 0.2}\n"
                              "ports:\n  - {name: end, region: {x: [3, 3]}, direction: [0, 1], cross_motion: held}\n"
                              "path: {to: 1, steps: 2}\n");
  EXPECT_NE(reasonFor(pin).find("radius"), std::string::npos) << reasonFor(pin);
}

/// A block that turns freely about a rigid cylinder follows its driven end without any force.
TEST(Cylinder, TurnsFreelyWithItsBody) {
  for (const int dimension : {2, 3}) {
    const std::string zero = dimension == 2 ? "" : ", 0";
    const std::string text = box(dimension == 2 ? "linear" : "linear_reduced", dimension,
                                 "pins:\n  - {name: axle, at: [1, 1], kind: cylinder, radius: 1}\n"
                                 "ports:\n  - {name: end, region: {x: [3, 3], y: [1, 1]}, direction: [0, 1" +
                                     zero +
                                     "], cross_motion: free}\n"
                                     "monitors:\n  - {name: turn, at: [1, 1" +
                                     zero + "], radius: 1}\npath: {to: 1.2, steps: 6}\n");
    const statics::SceneCurve curve = trace(sceneFromText(text));
    ASSERT_EQ(curve.path.status, solver::SolveStatus::CONVERGED) << curve.path.message;
    EXPECT_NEAR(curve.path.points.back().energy, 0, 1e-12);
    EXPECT_NEAR(curve.monitors.back()[0], std::asin(0.6), 1e-6);
  }
}

}  // namespace
}  // namespace snapwing::scene
