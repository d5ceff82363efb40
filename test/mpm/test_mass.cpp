// The mass matrix against closed forms of a block and against the moving mass of a path.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "snapwing/elasticity/neo_hookean.h"
#include "snapwing/mpm/mass.h"
#include "snapwing/mpm/moving_mass.h"

namespace snapwing::mpm {
namespace {

constexpr double CELL = 0.01, DENSITY = 1200, FILLED = 0.5;

template <int D>
std::unique_ptr<Discretisation<D>> block(Kernel kernel) {
  auto solid = std::make_unique<Discretisation<D>>();
  Grid<D> grid;
  grid.kernel = kernel;
  grid.cell_size = CELL;
  grid.cells[0] = 4, grid.cells[1] = 3;
  if constexpr (D == 3) grid.cells[2] = 2;
  const int model = solid->addModel(std::make_shared<elasticity::NeoHookean<D>>(
      elasticity::Material{5.5e6, 0.45, DENSITY}, elasticity::DensityInterpolation{}, elasticity::Plane::STRAIN));
  const int rule = solid->addRule(gaussRule<D>(grid, 3));
  const int kind = solid->addKind({{rule, model}});
  solid->addBody(grid);
  for (int c = 0; c < grid.cellCount(); ++c) solid->addCell(grid.cellIndex(c), {kind, FILLED, std::pow(CELL, D)});
  solid->finish();
  return solid;
}

/// A motion without strain: turned by a quarter about the origin and moved.
template <int D>
Eigen::VectorXd turned(const Discretisation<D>& solid, Vector<D> shift) {
  Eigen::VectorXd u(solid.dofCount());
  for (int n = 0; n < solid.nodeCount(); ++n) {
    Vector<D> x = solid.position(n), y = x;
    y(0) = -x(1), y(1) = x(0);
    u.template segment<D>(D * n) = y + shift - x;
  }
  return u;
}

template <int D>
void checkMoments(Kernel kernel) {
  const auto solid = block<D>(kernel);
  const Mass<D> mass(*solid, {DENSITY});
  Vector<D> size, shift = Vector<D>::Constant(0.3);
  size(0) = 4 * CELL, size(1) = 3 * CELL;
  if constexpr (D == 3) size(2) = 2 * CELL;
  const double total = FILLED * DENSITY * size.prod();
  const MassMoments<D> rest = mass.moments(Eigen::VectorXd::Zero(solid->dofCount()));
  EXPECT_NEAR(rest.total, total, 1e-13 * total);
  EXPECT_LT((rest.centre - 0.5 * size).norm(), 1e-13 * size.norm());
  const elasticity::Matrix<D> second = (total / 12 * size.cwiseAbs2()).asDiagonal();
  EXPECT_LT((rest.second - second).norm(), 1e-12 * second.norm());
  const MassMoments<D> moved = mass.moments(turned<D>(*solid, shift));
  EXPECT_NEAR(moved.centre(0), shift(0) - 0.5 * size(1), 1e-13);
  EXPECT_NEAR(moved.centre(1), shift(1) + 0.5 * size(0), 1e-13);
  EXPECT_NEAR(moved.second(0, 0), second(1, 1), 1e-12 * second.norm());
  EXPECT_NEAR(moved.second(1, 1), second(0, 0), 1e-12 * second.norm());
}

TEST(Mass, MomentsOfABlockAreInClosedForm) {
  checkMoments<2>(Kernel::LINEAR);
  checkMoments<2>(Kernel::QUADRATIC);
  checkMoments<3>(Kernel::LINEAR);
}

TEST(Mass, KineticEnergyOfAPathIsThatOfTheMovingMass) {
  const auto solid = block<3>(Kernel::LINEAR);
  Eigen::VectorXd rate(solid->dofCount());
  for (int k = 0; k < rate.size(); ++k) rate(k) = std::sin(1.3 * k);
  const Mass<3> mass(*solid, {DENSITY});
  const MovingMass moving = movingMass<3>(*solid, {DENSITY}, rate, Vector<3>(0, 0.6, 0.8));
  EXPECT_NEAR(rate.dot(mass.multiply(rate)), moving.kinetic, 1e-13 * moving.kinetic);
  Eigen::VectorXd axis(solid->dofCount());
  for (int n = 0; n < solid->nodeCount(); ++n) axis.segment<3>(3 * n) << 0, 0.6, 0.8;
  EXPECT_NEAR(axis.dot(mass.multiply(rate)), moving.coupled, 1e-12 * moving.kinetic);
  EXPECT_NEAR(axis.dot(mass.multiply(axis)), moving.mass, 1e-13 * moving.mass);
}

TEST(Mass, LumpedKeepsTotalAndCentre) {
  const auto solid = block<2>(Kernel::LINEAR);
  const Mass<2> consistent(*solid, {DENSITY}), lumped(*solid, {DENSITY}, {}, MassKind::LUMPED);
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(solid->dofCount());
  const MassMoments<2> a = consistent.moments(none), b = lumped.moments(none);
  EXPECT_NEAR(a.total, b.total, 1e-14 * a.total);
  EXPECT_LT((a.centre - b.centre).norm(), 1e-14);
  EXPECT_GT(b.second(0, 0), 1.05 * a.second(0, 0)) << "lumping puts the mass farther out";
  for (int column = 0; column < solid->pattern().nodes(); ++column) {
    for (int k = solid->pattern().start()[column]; k < solid->pattern().start()[column + 1]; ++k) {
      if (solid->pattern().row()[k] == column) {
        EXPECT_GT(lumped.blocks()[k], 0);
      } else {
        EXPECT_EQ(lumped.blocks()[k], 0);
      }
    }
  }
}

}  // namespace
}  // namespace snapwing::mpm
