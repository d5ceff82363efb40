// Void is linear: its Hessian is summed once. It must be what the law says point by point, at each order.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "snapwing/elasticity/neo_hookean.h"
#include "snapwing/mpm/discretisation.h"

namespace snapwing::mpm {
namespace {

using elasticity::DensityInterpolation;
using elasticity::Matrix;
using elasticity::NeoHookean;
using elasticity::Order;
using elasticity::Part;
using elasticity::Plane;
using elasticity::Response;
using Value = DensityInterpolation::Value;
const elasticity::Material TPU{5.5e6, 0.48, 1210};

/// The same law, which does not tell where it is linear.
template <int D>
class Silent : public NeoHookean<D> {
 public:
  using NeoHookean<D>::NeoHookean;
  bool linear(const Value&) const override { return false; }
};

struct Scene {
  Kernel kernel = Kernel::LINEAR;
  bool split = false;
  Plane plane = Plane::STRAIN;
};

template <int D>
std::shared_ptr<const NeoHookean<D>> law(bool silent, Plane plane, Part part) {
  if (silent) return std::make_shared<Silent<D>>(TPU, DensityInterpolation(), plane, part);
  return std::make_shared<NeoHookean<D>>(TPU, DensityInterpolation(), plane, part);
}

/// Two kinds of cells: whole and half as thick.
template <int D>
Discretisation<D> block(const Scene& scene, bool silent) {
  Discretisation<D> solid;
  Grid<D> grid;
  grid.kernel = scene.kernel;
  grid.cell_size = 1e-3;
  for (int a = 0; a < D; ++a) grid.cells[a] = 5 - a;
  std::vector<Term> terms;
  if (scene.split) {
    terms.push_back({solid.addRule(gaussRule<D>(grid, 2)), solid.addModel(law<D>(silent, scene.plane, Part::SHEAR))});
    terms.push_back({solid.addRule(gaussRule<D>(grid, 1)), solid.addModel(law<D>(silent, scene.plane, Part::VOLUME))});
  } else {
    terms.push_back({solid.addRule(gaussRule<D>(grid, 2)), solid.addModel(law<D>(silent, scene.plane, Part::ALL))});
  }
  const int kinds[] = {solid.addKind(terms), solid.addKind(terms)};
  solid.addBody(grid);
  for (int c = 0; c < grid.cellCount(); ++c) {
    solid.addCell(grid.cellIndex(c), {kinds[c % 2], 1, std::pow(1e-3, D) / (1 + c % 2)});
  }
  solid.finish();
  return solid;
}

template <int D>
std::vector<double> densities(const Discretisation<D>& solid, int shift) {
  std::vector<double> result;
  for (int c = 0; c < solid.cellCount(); ++c) result.push_back(std::vector<double>{0, 0.01, 1, 0.3}[(c + shift) % 4]);
  return result;
}

Eigen::Map<const Eigen::VectorXd> mapped(const std::vector<double>& values) {
  return {values.data(), static_cast<Eigen::Index>(values.size())};
}

template <int D>
void compare(const Discretisation<D>& told, const Discretisation<D>& silent, const Eigen::VectorXd& u, Order order) {
  Assembly one, other;
  one.add_blocks = other.add_blocks = elasticity::withTangent(order);
  one.blocks = other.blocks = std::vector<double>(static_cast<std::size_t>(told.pattern().blocks()) * D * D + 3, 7.0);
  told.assemble(u, order, 1, one);
  silent.assemble(u, order, 1, other);
  ASSERT_TRUE(one.finite && other.finite);
  EXPECT_NEAR(one.energy, other.energy, 1e-14 * other.energy);
  EXPECT_EQ(one.min_det_f, other.min_det_f);
  if (order == Order::ENERGY) return;
  EXPECT_LT((one.gradient - other.gradient).norm(), 1e-14 * other.force_scale);
  EXPECT_NEAR(one.force_scale, other.force_scale, 1e-13 * other.force_scale);
  EXPECT_LT((mapped(one.blocks) - mapped(other.blocks)).norm(), 1e-13 * mapped(other.blocks).norm());
}

template <int D>
void compareAll(const Scene& scene) {
  Discretisation<D> told = block<D>(scene, false), silent = block<D>(scene, true);
  std::mt19937 rng(7);
  std::uniform_real_distribution<double> uniform(-1.5e-4, 1.5e-4);
  const Eigen::VectorXd u = Eigen::VectorXd::NullaryExpr(told.dofCount(), [&] { return uniform(rng); });
  // Other cells each time, and none at the end.
  for (int shift = 0; shift < 3; ++shift) {
    const std::vector<double> rho =
        shift < 2 ? densities(told, shift) : std::vector<double>(static_cast<std::size_t>(told.cellCount()), 0.5);
    told.setDensities(rho);
    silent.setDensities(rho);
    for (const Order order : {Order::ENERGY, Order::STRESS, Order::TANGENT, Order::PROJECTED, Order::ABSOLUTE}) {
      compare(told, silent, u, order);
    }
  }
}

TEST(LinearCells, AreWhatTheLawSaysPlanar) {
  compareAll<2>({Kernel::LINEAR, false, Plane::STRAIN});
  compareAll<2>({Kernel::LINEAR, true, Plane::STRAIN});
  compareAll<2>({Kernel::LINEAR, false, Plane::STRESS});
  compareAll<2>({Kernel::QUADRATIC, false, Plane::STRESS});
}

TEST(LinearCells, AreWhatTheLawSaysVolumetric) {
  compareAll<3>({Kernel::LINEAR, false});
  compareAll<3>({Kernel::LINEAR, true});
  compareAll<3>({Kernel::QUADRATIC, false});
}

/// They may turn inside out, as the law says point by point.
TEST(LinearCells, AllVoidInvertsWithoutHarm) {
  Discretisation<2> told = block<2>({}, false);
  told.setDensities(std::vector<double>(static_cast<std::size_t>(told.cellCount()), 0.0));
  Eigen::VectorXd u(told.dofCount());
  for (int n = 0; n < told.nodeCount(); ++n) u.segment<2>(2 * n) = -3 * told.position(n);
  Assembly at;
  told.assemble(u, Order::TANGENT, 1, at);
  EXPECT_TRUE(at.finite);
  EXPECT_GT(at.energy, 0);
  EXPECT_EQ(at.min_det_f, 1);
}

/// What the mix would add where it is taken as zero is less than rounding.
template <int D>
void checkLimit(Plane plane) {
  const NeoHookean<D> law(TPU, DensityInterpolation(), plane);
  Matrix<D> f;
  for (int k = 0; k < D * D; ++k) f(k) = std::sin(3.0 * k + 1) + (k % (D + 1) == 0 ? 1 : 0);
  const auto response = [&](double mix) {
    Response<D> r;
    const Value value = {1e-5, 0, mix, 0};
    EXPECT_TRUE(law.evaluatePrepared(f, value, Order::TANGENT, r));
    return std::make_pair(r.stress, elasticity::fullTangent<D>(law.shared(value, Order::TANGENT), r));
  };
  const auto with = response(DensityInterpolation::LINEAR_MIX), without = response(0);
  EXPECT_LT((with.first - without.first).norm(), 1e-14 * without.first.norm());
  EXPECT_LT((with.second - without.second).norm(), 1e-14 * without.second.norm());
}

TEST(LinearCells, TheLimitIsBelowRounding) {
  checkLimit<2>(Plane::STRAIN);
  checkLimit<2>(Plane::STRESS);
  checkLimit<3>(Plane::STRAIN);
  const DensityInterpolation interpolation;
  EXPECT_EQ(interpolation.at(0.01).mix, 0);
  EXPECT_EQ(interpolation.at(0.01).mix_slope, 0);
  EXPECT_GT(interpolation.at(0.03).mix, DensityInterpolation::LINEAR_MIX);
}

}  // namespace
}  // namespace snapwing::mpm
