#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "snapwing/common/error.h"
#include "snapwing/elasticity/neo_hookean.h"
#include "snapwing/mpm/discretisation.h"
#include "support/derivative_check.h"

namespace snapwing::mpm {
namespace {

using elasticity::Order;
const elasticity::Material TPU{5.5e6, 0.48, 1210};

/// A small block with graded density and a hole, so that no symmetry hides a mistake.
template <int D>
Discretisation<D> block(Kernel kernel, bool split = false) {
  Discretisation<D> solid;
  Grid<D> grid;
  grid.kernel = kernel;
  grid.cell_size = 1e-3;
  grid.origin.setConstant(-2e-3);
  for (int a = 0; a < D; ++a) grid.cells[a] = 4 - a;
  const auto add = [&](elasticity::Part part) {
    return solid.addModel(std::make_shared<elasticity::NeoHookean<D>>(TPU, elasticity::DensityInterpolation(),
                                                                      elasticity::Plane::STRAIN, part));
  };
  std::vector<Term> terms;
  if (split) {
    terms.push_back({solid.addRule(gaussRule<D>(grid, 2)), add(elasticity::Part::SHEAR)});
    terms.push_back({solid.addRule(gaussRule<D>(grid, 1)), add(elasticity::Part::VOLUME)});
  } else {
    terms.push_back({solid.addRule(gaussRule<D>(grid, 2)), add(elasticity::Part::ALL)});
  }
  const int kind = solid.addKind(terms);
  solid.addBody(grid);
  for (int c = 0; c < grid.cellCount(); ++c) {
    if (c == 5) continue;
    solid.addCell(grid.cellIndex(c), {kind, 0.2 + 0.8 * ((7 * c) % 11) / 10.0, std::pow(1e-3, D)});
  }
  solid.finish();
  return solid;
}

template <int D>
Eigen::VectorXd randomField(const Discretisation<D>& solid, double size, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> uniform(-size, size);
  Eigen::VectorXd u(solid.dofCount());
  for (int i = 0; i < u.size(); ++i) u(i) = uniform(rng);
  return u;
}

template <int D>
Eigen::VectorXd linearField(const Discretisation<D>& solid, const elasticity::Matrix<D>& f, double shift = 0) {
  Eigen::VectorXd u(solid.dofCount());
  for (int n = 0; n < solid.nodeCount(); ++n) {
    u.template segment<D>(D * n) = (f - elasticity::Matrix<D>::Identity()) * solid.position(n);
    u.template segment<D>(D * n).array() += shift;
  }
  return u;
}

template <int D>
void checkDerivatives(Kernel kernel, bool split) {
  const Discretisation<D> solid = block<D>(kernel, split);
  const Eigen::VectorXd u = randomField(solid, 1.5e-4, 7), v = randomField(solid, 1, 8);
  Assembly at, moved;
  solid.assemble(u, Order::TANGENT, 1, at);
  ASSERT_TRUE(at.finite);
  EXPECT_TRUE(test::derivativeMatches(
      [&](double h) {
        solid.assemble(u + h * v, Order::ENERGY, 1, moved);
        return Eigen::VectorXd::Constant(1, moved.energy);
      },
      Eigen::VectorXd::Constant(1, at.gradient.dot(v)), 1e-3, 1e-7));
  EXPECT_TRUE(test::derivativeMatches(
      [&](double h) {
        solid.assemble(u + h * v, Order::STRESS, 1, moved);
        return moved.gradient;
      },
      solid.pattern().multiply(at.blocks, v), 1e-3, 1e-7));
}

TEST(Discretisation, DerivativesLinearPlanar) { checkDerivatives<2>(Kernel::LINEAR, false); }
TEST(Discretisation, DerivativesLinearReducedPlanar) { checkDerivatives<2>(Kernel::LINEAR, true); }
TEST(Discretisation, DerivativesQuadraticPlanar) { checkDerivatives<2>(Kernel::QUADRATIC, false); }
TEST(Discretisation, DerivativesLinearVolumetric) { checkDerivatives<3>(Kernel::LINEAR, false); }
TEST(Discretisation, DerivativesLinearReducedVolumetric) { checkDerivatives<3>(Kernel::LINEAR, true); }
TEST(Discretisation, DerivativesQuadraticVolumetric) { checkDerivatives<3>(Kernel::QUADRATIC, false); }

/// Projected Hessians must be those of the exact one where that is positive, and never have a negative direction.
TEST(Discretisation, ProjectedHessianIsPositive) {
  const Discretisation<2> solid = block<2>(Kernel::LINEAR);
  const Eigen::VectorXd u = randomField(solid, 1.5e-4, 7);
  Assembly exact, projected;
  solid.assemble(u, Order::TANGENT, 1, exact);
  solid.assemble(u, Order::PROJECTED, 1, projected);
  double least_exact = 0;
  for (unsigned seed = 0; seed < 400; ++seed) {
    const Eigen::VectorXd v = randomField(solid, 1, seed);
    const double p = v.dot(solid.pattern().multiply(projected.blocks, v));
    EXPECT_GE(p, 0);
    least_exact = std::min(least_exact, v.dot(solid.pattern().multiply(exact.blocks, v)) - p);
  }
  EXPECT_LT(least_exact, 0) << "projection changed nothing: nothing was tested";
}

template <int D>
void checkLinearFields(Kernel kernel, bool split = false) {
  // A rigid motion costs nothing (solid cells); a homogeneous stretch is met exactly and balanced inside.
  Discretisation<D> solid = block<D>(kernel, split);
  solid.setDensities(std::vector<double>(solid.cellCount(), 1.0));
  const Eigen::Vector3d axis = D == 2 ? Eigen::Vector3d(0, 0, 1) : Eigen::Vector3d(1, -2, 3).normalized();
  const Eigen::Matrix3d turned = Eigen::AngleAxisd(2.0, axis).toRotationMatrix();
  const elasticity::Matrix<D> rotation = turned.topLeftCorner<D, D>();
  Assembly at;
  solid.assemble(linearField(solid, rotation, 5e-3), Order::STRESS, 1, at);
  const double volume = solid.cellCount() * std::pow(1e-3, D);
  EXPECT_LT(std::abs(at.energy), 1e-10 * TPU.youngs_modulus * volume);
  EXPECT_LT(at.gradient.norm(), 1e-10 * TPU.youngs_modulus * std::pow(1e-3, D - 1));
  EXPECT_NEAR(at.min_det_f, 1, 1e-12);
  elasticity::Matrix<D> stretch = elasticity::Matrix<D>::Identity();
  stretch(0, 0) = 1.3;
  stretch(0, 1) = 0.2;
  solid.assemble(linearField(solid, stretch), Order::STRESS, 1, at);
  double energy = 0;
  for (int part = 0; part < (split ? 2 : 1); ++part) {
    elasticity::Response<D> r;
    ASSERT_TRUE(solid.model(part).evaluate(stretch, 1, Order::STRESS, r));
    energy += r.energy;
  }
  EXPECT_NEAR(at.energy, energy * volume, 1e-10 * at.energy);
  EXPECT_NEAR(at.gradient.sum(), 0, 1e-9 * at.force_scale);
  EXPECT_NEAR(at.min_det_f, stretch.determinant(), 1e-12);
  // Each node turns as the field does, whatever the stretch.
  const elasticity::Matrix<D> symmetric = stretch.transpose() * stretch;
  for (const auto& node : solid.nodeRotations(linearField(solid, elasticity::Matrix<D>(rotation * symmetric)))) {
    EXPECT_LT((node - rotation).norm(), 1e-12);
  }
}

TEST(Discretisation, LinearFieldsLinearPlanar) { checkLinearFields<2>(Kernel::LINEAR); }
TEST(Discretisation, LinearFieldsLinearReducedPlanar) { checkLinearFields<2>(Kernel::LINEAR, true); }
TEST(Discretisation, LinearFieldsQuadraticPlanar) { checkLinearFields<2>(Kernel::QUADRATIC); }
TEST(Discretisation, LinearFieldsLinearVolumetric) { checkLinearFields<3>(Kernel::LINEAR); }
TEST(Discretisation, LinearFieldsLinearReducedVolumetric) { checkLinearFields<3>(Kernel::LINEAR, true); }
TEST(Discretisation, LinearFieldsQuadraticVolumetric) { checkLinearFields<3>(Kernel::QUADRATIC); }

TEST(Discretisation, SameBitsForAnyThreadCount) {
  for (const Kernel kernel : {Kernel::LINEAR, Kernel::QUADRATIC}) {
    const Discretisation<3> solid = block<3>(kernel);
    const Eigen::VectorXd u = randomField(solid, 1e-4, 3);
    Assembly one, other;
    solid.assemble(u, Order::TANGENT, 1, one);
    for (const int threads : {2, 3, 7}) {
      solid.assemble(u, Order::TANGENT, threads, other);
      EXPECT_EQ(one.energy, other.energy);
      EXPECT_EQ(one.force_scale, other.force_scale);
      EXPECT_TRUE(one.gradient == other.gradient);
      EXPECT_TRUE(one.blocks == other.blocks);
    }
  }
}

TEST(Discretisation, DensityDerivatives) {
  Discretisation<2> solid = block<2>(Kernel::QUADRATIC);
  const Eigen::VectorXd u = randomField(solid, 1.5e-4, 1), v = randomField(solid, 1, 2);
  std::vector<double> density(solid.cellCount(), 0.5);
  for (int c = 0; c < solid.cellCount(); ++c) density[c] = 0.3 + 0.05 * (c % 9);
  Assembly at;
  const auto value = [&](double h, bool force) {
    std::vector<double> moved = density;
    for (int c = 0; c < solid.cellCount(); ++c) moved[c] += h * std::cos(c);
    solid.setDensities(moved);
    solid.assemble(u, Order::STRESS, 1, at);
    return Eigen::VectorXd::Constant(1, force ? at.gradient.dot(v) : at.energy);
  };
  solid.setDensities(density);
  const Eigen::VectorXd d_energy = solid.densityDerivative(u, {}), d_force = solid.densityDerivative(u, v);
  double energy_slope = 0, force_slope = 0;
  for (int c = 0; c < solid.cellCount(); ++c) {
    energy_slope += d_energy(c) * std::cos(c);
    force_slope += d_force(c) * std::cos(c);
  }
  EXPECT_TRUE(test::derivativeMatches([&](double h) { return value(h, false); },
                                      Eigen::VectorXd::Constant(1, energy_slope), 1, 1e-7));
  EXPECT_TRUE(test::derivativeMatches([&](double h) { return value(h, true); },
                                      Eigen::VectorXd::Constant(1, force_slope), 1, 1e-7));
}

TEST(Discretisation, NamesTheInvertedCell) {
  const Discretisation<2> solid = block<2>(Kernel::LINEAR);
  elasticity::Matrix<2> f = elasticity::Matrix<2>::Identity();
  f(0, 0) = -1;
  Assembly at;
  solid.assemble(linearField(solid, f), Order::TANGENT, 1, at);
  EXPECT_FALSE(at.finite);
  EXPECT_GE(at.min_det_f_cell, 0);
  EXPECT_LT(at.min_det_f, 0);
}

TEST(Grid, KernelsSumToOneAndReproducePositions) {
  for (const Kernel kernel : {Kernel::LINEAR, Kernel::QUADRATIC}) {
    Discretisation<2> solid = block<2>(kernel);
    const Vector<2> point(-0.3e-3, -1.4e-3);
    Vector<2> mean = Vector<2>::Zero();
    double sum = 0;
    for (const auto& [node, weight] : solid.interpolate(0, point)) {
      mean += weight * solid.position(node);
      sum += weight;
    }
    EXPECT_NEAR(sum, 1, 1e-14);
    EXPECT_LT((mean - point).norm(), 1e-17);
  }
  EXPECT_TRUE(block<2>(Kernel::LINEAR).interpolate(0, Vector<2>(1, 1)).empty());
}

}  // namespace
}  // namespace snapwing::mpm
