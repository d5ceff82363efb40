// The power series of a solid's force along a path, against the force itself.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "snapwing/elasticity/neo_hookean.h"
#include "snapwing/elasticity/saint_venant_kirchhoff.h"
#include "snapwing/mpm/solid_series.h"

namespace snapwing::mpm {
namespace {

using elasticity::DensityInterpolation;
using elasticity::NeoHookean;
using elasticity::Order;
using elasticity::Part;
using elasticity::Plane;
const elasticity::Material TPU{5.5e6, 0.48, 1210};

/// Cells of all kinds of density, one kind of them cut.
template <int D>
Discretisation<D> block(Kernel kernel, bool split, Plane plane, bool svk = false) {
  Discretisation<D> solid;
  Grid<D> grid;
  grid.kernel = kernel;
  grid.cell_size = 1e-3;
  for (int a = 0; a < D; ++a) grid.cells[a] = 5 - a;
  const auto law = [&](Part part) {
    return solid.addModel(std::make_shared<NeoHookean<D>>(TPU, DensityInterpolation(), plane, part));
  };
  const int whole = solid.addRule(gaussRule<D>(grid, 2));
  std::vector<Term> terms;
  if (split) {
    terms = {{whole, law(Part::SHEAR)}, {solid.addRule(gaussRule<D>(grid, 1)), law(Part::VOLUME)}};
  } else if (svk) {
    using Law = elasticity::SaintVenantKirchhoff<D>;
    terms = {{whole, solid.addModel(std::make_shared<Law>(TPU, DensityInterpolation(), plane))}};
  } else {
    terms = {{whole, law(Part::ALL)}};
  }
  const int kinds[] = {solid.addKind(terms), solid.addKind(terms)};
  solid.addBody(grid);
  const double densities[] = {1, 0.3, 0.215, 0.01, 0};
  for (int c = 0; c < grid.cellCount(); ++c) {
    solid.addCell(grid.cellIndex(c), {kinds[c % 2], densities[c % 5], std::pow(1e-3, D) / (1 + c % 2)});
  }
  solid.finish();
  return solid;
}

/// What n coefficients leave of the force falls with the power n of the way.
template <int D>
void compare(const Discretisation<D>& solid) {
  constexpr int HIGHEST = 7;
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> uniform(-1.5e-4, 1.5e-4);
  Eigen::VectorXd path[3];
  for (Eigen::VectorXd& u : path) u = Eigen::VectorXd::NullaryExpr(solid.dofCount(), [&] { return uniform(rng); });
  Assembly at;
  at.add_blocks = false;
  solid.assemble(path[0], Order::TANGENT, 1, at);
  ASSERT_TRUE(at.finite);
  const auto blocks = at.blocks;
  ASSERT_TRUE(SolidSeries<D>::possible(solid));
  SolidSeries<D> series(solid, HIGHEST);
  series.start(path[0]);
  std::vector<Eigen::VectorXd> coefficients = {at.gradient};
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(solid.dofCount());
  Eigen::VectorXd remainder = zero;
  for (int k = 1; k <= HIGHEST; ++k) {
    const Eigen::VectorXd& u = k < 3 ? path[k] : zero;
    coefficients.push_back(solid.pattern().multiply(blocks, u) + remainder);
    remainder.setZero();
    if (k < HIGHEST) series.advance(k, u, remainder);
  }
  const auto error = [&](int count, double t) {
    solid.assemble(path[0] + t * path[1] + t * t * path[2], Order::STRESS, 1, at);
    Eigen::VectorXd left = at.gradient;
    for (int k = 0; k < count; ++k) left -= std::pow(t, k) * coefficients[k];
    return left.norm();
  };
  for (int count = 2; count <= HIGHEST + 1; ++count) {
    const double t = std::pow(1e-8, 1.0 / count);
    const double far = error(count, 0.5 * t), near = error(count, 0.25 * t);
    EXPECT_LT(near, std::max(std::pow(0.62, count) * far, 1e-14 * at.force_scale)) << count << " coefficients";
    if (count <= 6) {  // Saint Venant's and Kirchhoff's forces end there, at the third power of u(t)
      EXPECT_GT(far, 1e-14 * at.force_scale) << "nothing was tested";
    }
  }
  EXPECT_LT(error(HIGHEST + 1, 0.02), 1e-9 * at.force_scale);
}

TEST(SolidSeries, IsThatOfTheForcePlanar) {
  compare(block<2>(Kernel::LINEAR, false, Plane::STRAIN));
  compare(block<2>(Kernel::LINEAR, true, Plane::STRAIN));
  compare(block<2>(Kernel::LINEAR, false, Plane::STRESS));
  compare(block<2>(Kernel::QUADRATIC, false, Plane::STRESS));
  compare(block<2>(Kernel::LINEAR, false, Plane::STRESS, true));
}

TEST(SolidSeries, IsThatOfTheForceVolumetric) {
  compare(block<3>(Kernel::LINEAR, false, Plane::STRAIN));
  compare(block<3>(Kernel::LINEAR, true, Plane::STRAIN));
  compare(block<3>(Kernel::QUADRATIC, false, Plane::STRAIN));
}

/// A law without a series is told, not taken as linear.
class Mute : public NeoHookean<2> {
 public:
  using NeoHookean<2>::NeoHookean;
  void writeStress(elasticity::TaylorTape&) const override {}
};

TEST(SolidSeries, IsRefusedWhereALawHasNone) {
  Discretisation<2> solid;
  Grid<2> grid;
  grid.kernel = Kernel::LINEAR;
  grid.cell_size = 1e-3;
  grid.cells[0] = grid.cells[1] = 2;
  const int rule = solid.addRule(gaussRule<2>(grid, 2));
  const int kind = solid.addKind({{rule, solid.addModel(std::make_shared<Mute>(TPU, DensityInterpolation()))}});
  solid.addBody(grid);
  for (int c = 0; c < grid.cellCount(); ++c) solid.addCell(grid.cellIndex(c), {kind, 1, 1e-6});
  solid.finish();
  EXPECT_FALSE(SolidSeries<2>::possible(solid));
}

}  // namespace
}  // namespace snapwing::mpm
