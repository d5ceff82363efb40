// Joints kept as constraints: the same equilibrium as with exact elimination, both methods, refusals.
#include <gtest/gtest.h>

#include "snapwing/common/error.h"
#include "snapwing/elasticity/neo_hookean.h"
#include "snapwing/solver/joint_equilibrium.h"
#include "snapwing/solver/newton.h"
#include "snapwing/solver/term_problem.h"

namespace snapwing::solver {
namespace {

/// Two strips of 6 x 2 cells of a millimetre, one above the other, in one discretisation.
std::shared_ptr<const mpm::Discretisation<2>> strips() {
  auto solid = std::make_shared<mpm::Discretisation<2>>();
  const int law = solid->addModel(std::make_shared<elasticity::NeoHookean<2>>(
      elasticity::Material{5.5e6, 0.4, 1210}, elasticity::DensityInterpolation{}, elasticity::Plane::STRESS));
  mpm::Grid<2> grid;
  grid.cell_size = 1e-3;
  grid.cells = {6, 2};
  grid.kernel = mpm::Kernel::QUADRATIC;
  const int kind = solid->addKind({{solid->addRule(mpm::gaussRule<2>(grid, 3)), law}});
  for (const double y : {0.0, 1e-3}) {
    grid.origin = {0, y};
    solid->addBody(grid);
    for (int c = 0; c < grid.cellCount(); ++c) solid->addCell(grid.cellIndex(c), {kind, 1, 1e-8});
  }
  solid->finish();
  return solid;
}

struct Rows {
  std::vector<Equation> equations;
  std::vector<std::string> names;
  ConstraintRows H;
  Eigen::VectorXd h;
};

/// First strip held at two points and bent at a third; the second hangs on it by two joints.
Rows rowsOf(const mpm::Discretisation<2>& solid, bool doubled) {
  Rows rows;
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<double> h;
  const auto add = [&](const std::string& name, int axis, Eigen::Vector2d at, bool joint, double value) {
    Equation e;
    e.name = name;
    e.constant = value;
    const auto put = [&](int body, double sign) {
      for (const auto& [node, weight] : solid.interpolate(body, at)) {
        e.terms.emplace_back(2 * node + axis, sign * weight);
        entries.emplace_back(static_cast<int>(h.size()), 2 * node + axis, sign * weight);
      }
    };
    put(0, 1);
    if (joint) put(1, -1);
    rows.equations.push_back(e);
    rows.names.push_back(name);
    h.push_back(value);
  };
  for (int axis = 0; axis < 2; ++axis) {
    add("hold", axis, {0.4e-3, 1.1e-3}, false, 0);
    add("joint 1", axis, {1.7e-3, 1.3e-3}, true, 0);
    add("joint 2", axis, {4.3e-3, 1.6e-3}, true, 0);
    if (doubled) add("joint 2 again", axis, {4.3e-3, 1.6e-3}, true, 0);
  }
  add("hold 2", 1, {3.1e-3, 0.6e-3}, false, 0);
  add("drive", 1, {5.6e-3, 0.7e-3}, false, 0.2e-3);
  rows.h = Eigen::Map<Eigen::VectorXd>(h.data(), static_cast<Eigen::Index>(h.size()));
  rows.H.resize(rows.h.size(), solid.dofCount());
  rows.H.setFromTriplets(entries.begin(), entries.end());
  return rows;
}

JointSettings settings(Enforcement enforcement) {
  JointSettings s;
  s.enforcement = enforcement;
  s.max_iterations = 300;
  s.force_tolerance = 1e-9;
  s.stiffness = 1e4;
  s.energy_floor = 1e-15 * 5.5e6 * 2.4e-7;
  return s;
}

TEST(JointEquilibrium, AgreesWithExactElimination) {
  const auto solid = strips();
  const Rows rows = rowsOf(*solid, false);
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(solid->dofCount());
  const TermProblem problem(solidParts<2>(
      solid, std::make_shared<const Coordinates>(Reduction(solid->dofCount(), 0, rows.equations)), 1, 1e-8));
  Newton newton(problem, {});
  Eigen::VectorXd z = Eigen::VectorXd::Zero(problem.freeCount());
  Evaluation at;
  const NewtonResult eliminated = newton.solve(Eigen::VectorXd(), z, at);
  ASSERT_TRUE(eliminated.converged()) << eliminated.message;
  for (const Enforcement enforcement : {Enforcement::MULTIPLIERS, Enforcement::AUGMENTED_LAGRANGIAN}) {
    JointEquilibrium<2> kept(solid, rows.H, rows.names, settings(enforcement));
    const JointResult result = kept.solve(none, rows.h, none);
    ASSERT_EQ(result.status, JointStatus::CONVERGED) << result.message;
    EXPECT_TRUE(result.stable);
    EXPECT_LT((result.u - at.place.y).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_NEAR(result.at.elastic_energy, at.elastic_energy, 1e-6 * at.elastic_energy);
    EXPECT_GT(result.multipliers.norm(), 1e-3);
  }
  EXPECT_GT(at.place.y.norm(), 2e-4);
}

TEST(JointEquilibrium, RepeatedJointsAreRefusedByName) {
  const auto solid = strips();
  const Rows rows = rowsOf(*solid, true);
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(solid->dofCount());
  JointEquilibrium<2> kept(solid, rows.H, rows.names, settings(Enforcement::MULTIPLIERS));
  const JointResult result = kept.solve(none, rows.h, none);
  EXPECT_EQ(result.status, JointStatus::RANK_DEFICIENT);
  EXPECT_NE(result.message.find("'joint 2 again'"), std::string::npos) << result.message;
  EXPECT_EQ(result.message.find("'hold'"), std::string::npos) << result.message;
  Eigen::MatrixXd x, y;
  EXPECT_THROW(kept.solveTangent(result.at, none, rows.h, &x, &y), common::Error);
  JointSettings bad = settings(Enforcement::MULTIPLIERS);
  bad.stiffness = 0;
  EXPECT_THROW(JointEquilibrium<2>(solid, rows.H, rows.names, bad), common::Error);
}

}  // namespace
}  // namespace snapwing::solver
