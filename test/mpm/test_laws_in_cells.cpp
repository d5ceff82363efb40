// Laws whose tangent differs between the particles of a cell in more than Q: assembly must take each particle's own.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <utility>

#include "snapwing/elasticity/neo_hookean.h"
#include "snapwing/mpm/discretisation.h"
#include "support/derivative_check.h"

namespace snapwing::mpm {
namespace {

using elasticity::Matrix;
using elasticity::Order;
using elasticity::Response;
using elasticity::SharedTangent;
using Value = elasticity::DensityInterpolation::Value;
const elasticity::Material TPU{5.5e6, 0.48, 1210};

template <int D>
std::shared_ptr<const elasticity::NeoHookean<D>> plainLaw() {
  return std::make_shared<elasticity::NeoHookean<D>>(TPU, elasticity::DensityInterpolation());
}

/// The same law, which states its tangent compactly where the material is stretched along x and as a matrix elsewhere.
template <int D>
class OfTwoForms : public elasticity::ConstitutiveModel<D> {
 public:
  Value prepare(double density) const override { return law_->prepare(density); }
  SharedTangent shared(const Value& cell, Order order) const override { return law_->shared(cell, order); }
  bool evaluatePrepared(const Matrix<D>& f, const Value& cell, Order order, Response<D>& out) const override {
    if (!law_->evaluatePrepared(f, cell, order, out)) return false;
    const bool wide = f(0, 0) > 1;
    ++(wide ? stretched : others);
    if (order != Order::TANGENT || wide) return true;
    out.full = elasticity::fullTangent<D>({}, out);
    out.compact = false;
    return true;
  }
  bool densityDerivative(const Matrix<D>& f, const Value& cell, double& energy, Matrix<D>& stress) const override {
    return law_->densityDerivative(f, cell, energy, stress);
  }
  mutable int stretched = 0, others = 0;

 private:
  std::shared_ptr<const elasticity::NeoHookean<D>> law_ = plainLaw<D>();
};

/// W = k (m |F|^2 / 2 + n |F|^4 / 4): the coefficient of dF grows with |F|^2, and only m of it is shared.
template <int D>
class Stiffening : public elasticity::ConstitutiveModel<D> {
 public:
  Value prepare(double density) const override { return elasticity::DensityInterpolation().at(density); }
  SharedTangent shared(const Value& cell, Order) const override { return {cell.stiffness * M, 0, 0}; }
  bool evaluatePrepared(const Matrix<D>& f, const Value& cell, Order order, Response<D>& out) const override {
    const double square = f.squaredNorm();
    out.det_f = f.determinant();
    out.energy = cell.stiffness * (0.5 * M * square + 0.25 * N * square * square);
    if (order == Order::ENERGY) return true;
    out.stress = cell.stiffness * (M + N * square) * f;
    const Eigen::Map<const Eigen::Matrix<double, D * D, 1>> v(f.data());
    out.compact = false;
    out.full = cell.stiffness * N * (2 * v * v.transpose());
    out.full.diagonal().array() += cell.stiffness * N * square;
    return true;
  }
  bool densityDerivative(const Matrix<D>&, const Value&, double&, Matrix<D>&) const override { return false; }

 private:
  static constexpr double M = 2e6, N = 3e6;  ///< [Pa]
};

template <int D>
Discretisation<D> block(std::shared_ptr<const elasticity::ConstitutiveModel<D>> law) {
  Discretisation<D> solid;
  Grid<D> grid;
  grid.cell_size = 1e-3;
  for (int a = 0; a < D; ++a) grid.cells[a] = 3 - (a > 0 ? 1 : 0);
  const int kind = solid.addKind({{solid.addRule(gaussRule<D>(grid, 2)), solid.addModel(std::move(law))}});
  solid.addBody(grid);
  for (int c = 0; c < grid.cellCount(); ++c) {
    solid.addCell(grid.cellIndex(c), {kind, c % 3 == 1 ? 0.2 : 1.0, std::pow(1e-3, D)});
  }
  solid.finish();
  return solid;
}

Eigen::VectorXd field(int size, double extent, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> uniform(-extent, extent);
  Eigen::VectorXd u(size);
  for (int i = 0; i < size; ++i) u(i) = uniform(rng);
  return u;
}

template <int D>
void checkHessian(const Discretisation<D>& solid) {
  const Eigen::VectorXd u = field(solid.dofCount(), 1.5e-4, 7), v = field(solid.dofCount(), 1, 8);
  Assembly at, moved;
  solid.assemble(u, Order::TANGENT, 1, at);
  ASSERT_TRUE(at.finite);
  EXPECT_TRUE(test::derivativeMatches(
      [&](double h) {
        solid.assemble(u + h * v, Order::STRESS, 1, moved);
        return moved.gradient;
      },
      solid.pattern().multiply(at.blocks, v), 1e-3, 1e-7));
}

template <int D>
void checkTwoForms() {
  const auto law = std::make_shared<OfTwoForms<D>>();
  const Discretisation<D> mixed = block<D>(law), plain = block<D>(plainLaw<D>());
  const Eigen::VectorXd u = field(plain.dofCount(), 1.5e-4, 7);
  Assembly one, other;
  mixed.assemble(u, Order::TANGENT, 1, one);
  plain.assemble(u, Order::TANGENT, 1, other);
  ASSERT_GT(law->stretched, plain.cellCount());
  ASSERT_GT(law->others, plain.cellCount()) << "one form alone: nothing was tested";
  const auto count = static_cast<Eigen::Index>(other.blocks.size());
  const Eigen::Map<const Eigen::VectorXd> a(one.blocks.data(), count), b(other.blocks.data(), count);
  EXPECT_LT((a - b).norm(), 1e-13 * b.norm());
  checkHessian(mixed);
}

TEST(LawsInCells, EachParticleMayStateItsTangentInAFormOfItsOwn) {
  checkTwoForms<2>();
  checkTwoForms<3>();
}

TEST(LawsInCells, WhatFollowsTheDeformationIsEachParticlesOwn) {
  checkHessian(block<2>(std::make_shared<Stiffening<2>>()));
  checkHessian(block<3>(std::make_shared<Stiffening<3>>()));
}

}  // namespace
}  // namespace snapwing::mpm
