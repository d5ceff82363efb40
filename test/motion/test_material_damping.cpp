// Damping laws of the material through the battery of terms; what each does to rigid motions and along a snap.
#include <cmath>

#include "snapwing/common/error.h"
#include "snapwing/solver/material_damping.h"
#include "support/block.h"
#include "support/term_check.h"

namespace snapwing::motion {
namespace {

using solver::LaggedTangent;

constexpr double AMPLITUDE = 6e-4;  // [m]

template <int D>
void checkLaw(const solver::Term& law, const mpm::Discretisation<D>& solid) {
  solver::Step step;
  step.h = 2e-3, step.kappa = 5e5;
  step.y0 = test::wavy(solid.dofCount(), AMPLITUDE, 0.3);
  step.v0 = Eigen::VectorXd::Zero(solid.dofCount());
  test::TermCase c{solver::HessianLayout(solid.dofCount()), {}};
  c.layout.addRegion(0, solid.pattern());
  c.y = {test::wavy(solid.dofCount(), AMPLITUDE, 0.0), test::wavy(solid.dofCount(), AMPLITUDE, 1.2)};
  c.step = &step;
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(1);
  checkTerm(test::WithKept(law, law.keep({step.y0, none})), c);
}

TEST(MaterialDamping, LawsAreTerms) {
  const auto plane = test::block<2>(elasticity::Plane::STRESS);
  const auto space = test::block<3>();
  const auto mass = std::make_shared<const mpm::Mass<2>>(*plane, std::vector<double>{test::BLOCK_DENSITY});
  checkLaw<2>(solver::RayleighTerm<2>(plane, mass, 3.0, 2e-3, LaggedTangent::EXACT), *plane);
  checkLaw<2>(solver::RayleighTerm<2>(plane, nullptr, 0, 2e-3, LaggedTangent::PROJECTED), *plane);
  checkLaw<3>(solver::RayleighTerm<3>(space, nullptr, 0, 2e-3, LaggedTangent::EXACT), *space);
  checkLaw<2>(solver::KelvinVoigtTerm<2>(plane, 2e-3), *plane);
  checkLaw<3>(solver::KelvinVoigtTerm<3>(space, 2e-3), *space);
  EXPECT_THROW(solver::KelvinVoigtTerm<2>(plane, -1), common::Error);
  EXPECT_THROW(solver::RayleighTerm<2>(plane, nullptr, 1, 0, LaggedTangent::EXACT), common::Error);
}

/// Kelvin-Voigt is objective: a block that turns loses nothing. Lagged Rayleigh brakes it.
TEST(MaterialDamping, KelvinVoigtLetsABlockTurn) {
  const auto solid = test::block<2>(elasticity::Plane::STRESS);
  solver::Step step;
  step.h = 1e-3;
  step.y0 = Eigen::VectorXd::Zero(solid->dofCount());
  step.v0 = step.y0;
  Eigen::VectorXd turned(solid->dofCount());
  for (int n = 0; n < solid->nodeCount(); ++n) {
    const Eigen::Vector2d x = solid->position(n);
    const double c = std::cos(0.3), s = std::sin(0.3);
    turned.segment<2>(2 * n) = Eigen::Vector2d(c * x(0) - s * x(1), s * x(0) + c * x(1)) - x;
  }
  const auto energy = [&](const solver::Term& term) {
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(1);
    const auto kept = term.keep({step.y0, none});
    solver::HessianLayout layout(solid->dofCount());
    layout.addRegion(0, solid->pattern());
    solver::Sum sum;
    sum.reset(layout, 1, solver::Order::ENERGY);
    term.evaluate({turned, none, &step, 1, kept.get()}, solver::Order::ENERGY, sum);
    return sum.energy;
  };
  EXPECT_LT(energy(solver::KelvinVoigtTerm<2>(solid, 1e-3)), 1e-12);
  EXPECT_GT(energy(solver::RayleighTerm<2>(solid, nullptr, 0, 1e-3, LaggedTangent::EXACT)), 1e-3);
}

}  // namespace
}  // namespace snapwing::motion
