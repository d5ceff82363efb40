#pragma once
/// The battery that every constitutive law goes through: rest, stress and tangent as slopes, symmetry, rotations,
/// projection, derivatives by the density.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "snapwing/elasticity/constitutive_model.h"
#include "snapwing/elasticity/material.h"
#include "support/derivative_check.h"

namespace snapwing::elasticity {

inline const Material TPU{5.5e6, 0.48, 1210};

template <int D>
Eigen::VectorXd vec(const Matrix<D>& m) {
  return Eigen::Map<const Eigen::VectorXd>(m.data(), D * D);
}

template <int D>
Matrix<D> randomMatrix(std::mt19937& rng, double size) {
  std::uniform_real_distribution<double> uniform(-size, size);
  Matrix<D> m;
  for (int i = 0; i < D * D; ++i) m.data()[i] = uniform(rng);
  return m;
}

/// Cayley's transform of a skew matrix.
template <int D>
Matrix<D> randomRotation(std::mt19937& rng) {
  const Matrix<D> m = randomMatrix<D>(rng, 1), skew = m - m.transpose(), one = Matrix<D>::Identity();
  return (one - skew).inverse() * (one + skew);
}

/// Large strain with positive determinant.
template <int D>
Matrix<D> randomGradient(std::mt19937& rng) {
  for (;;) {
    const Matrix<D> f = Matrix<D>::Identity() + randomMatrix<D>(rng, 0.6);
    if (f.determinant() > 0.2) return f;
  }
}

template <int D>
struct Variant {
  std::string name;
  std::shared_ptr<ConstitutiveModel<D>> model;
  bool rests = true;  ///< without stress at rest: parts of a law need not
};
template <int D>
using Laws = std::vector<Variant<D>>;

/// Densities: solid, in between, and where the void's linear energy takes over (rho^3 near the threshold .01).
constexpr double DENSITIES[] = {1.0, 0.6, 0.215, 0.1};

template <int D>
void checkAtRest(const Laws<D>& laws) {
  for (const auto& v : laws) {
    for (const double rho : DENSITIES) {
      Response<D> r;
      ASSERT_TRUE(v.model->evaluate(Matrix<D>::Identity(), rho, Order::TANGENT, r)) << v.name;
      EXPECT_NEAR(r.energy, 0, 1e-9) << v.name;
      if (v.rests) {
        EXPECT_NEAR(r.stress.norm(), 0, 1e-7) << v.name;
      }
      EXPECT_EQ(r.det_f, 1) << v.name;
    }
  }
}

template <int D>
void checkDerivatives(const Laws<D>& laws) {
  std::mt19937 rng(7);
  for (const auto& v : laws) {
    for (const double rho : DENSITIES) {
      const Matrix<D> f = randomGradient<D>(rng), direction = randomMatrix<D>(rng, 1);
      Response<D> r;
      ASSERT_TRUE(v.model->evaluate(f, rho, Order::TANGENT, r));
      const SharedTangent shared = v.model->shared(v.model->prepare(rho), Order::TANGENT);
      const Eigen::MatrixXd full = fullTangent<D>(shared, r);
      const auto response = [&](double h, Order order) {
        Response<D> moved;
        EXPECT_TRUE(v.model->evaluate(f + h * direction, rho, order, moved));
        return moved;
      };
      const Eigen::VectorXd power = Eigen::VectorXd::Constant(1, r.stress.cwiseProduct(direction).sum());
      EXPECT_TRUE(test::derivativeMatches(
          [&](double h) { return Eigen::VectorXd::Constant(1, response(h, Order::ENERGY).energy); }, power, 1, 1e-7))
          << v.name << " P = dW/dF at density " << rho;
      EXPECT_TRUE(test::derivativeMatches([&](double h) { return vec<D>(response(h, Order::STRESS).stress); },
                                          full * vec<D>(direction), 1, 1e-7))
          << v.name << " tangent at density " << rho;
      EXPECT_LT((full - full.transpose()).norm(), 1e-12 * full.norm()) << v.name;
      EXPECT_LT((full * vec<D>(direction) - vec<D>(tangentTimes<D>(shared, r, direction))).norm(),
                1e-12 * full.norm() * direction.norm());
    }
  }
}

template <int D>
void checkDensityDerivatives(const Laws<D>& laws) {
  std::mt19937 rng(11);
  for (const auto& v : laws) {
    for (const double rho : {0.9, 0.6, 0.3, 0.215, 0.1}) {
      const Matrix<D> f = randomGradient<D>(rng);
      double d_energy = 0;
      Matrix<D> d_stress;
      ASSERT_TRUE(v.model->densityDerivative(f, v.model->prepare(rho), d_energy, d_stress));
      const auto at = [&](double h) {
        Response<D> r;
        EXPECT_TRUE(v.model->evaluate(f, rho + h, Order::STRESS, r));
        return r;
      };
      // gamma(rho) turns within about .01 of its threshold: steps are small against that.
      EXPECT_TRUE(test::derivativeMatches([&](double h) { return Eigen::VectorXd::Constant(1, at(h).energy); },
                                          Eigen::VectorXd::Constant(1, d_energy), 0.05, 1e-6))
          << v.name << " dW/drho at " << rho;
      EXPECT_TRUE(test::derivativeMatches([&](double h) { return vec<D>(at(h).stress); }, vec<D>(d_stress), 0.05, 1e-6))
          << v.name << " dP/drho at " << rho;
    }
  }
}

template <int D>
void checkRotation(const Laws<D>& laws) {
  std::mt19937 rng(5);
  const Matrix<D> f = randomGradient<D>(rng);
  const Matrix<D> turn = randomRotation<D>(rng);
  for (const auto& v : laws) {
    Response<D> still, turned;
    ASSERT_TRUE(v.model->evaluate(f, 1, Order::STRESS, still));
    ASSERT_TRUE(v.model->evaluate(turn * f, 1, Order::STRESS, turned));
    EXPECT_NEAR(turned.energy, still.energy, 1e-12 * (std::abs(still.energy) + TPU.youngs_modulus)) << v.name;
    EXPECT_LT((turned.stress - turn * still.stress).norm(), 1e-9 * TPU.youngs_modulus) << v.name;
  }
}

/// The projected tangent equals the eigenvalue clamp of the exact one, found by a general eigensolver.
template <int D>
void checkProjection(const Laws<D>& laws) {
  std::mt19937 rng(3);
  int indefinite = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const Matrix<D> f = randomGradient<D>(rng) * (trial % 2 ? 0.75 : 1.0);
    for (const auto& v : laws) {
      Response<D> r;
      Response<D> exact;
      ASSERT_TRUE(v.model->evaluate(f, 1, Order::PROJECTED, r));
      ASSERT_TRUE(v.model->evaluate(f, 1, Order::TANGENT, exact));
      const auto state = v.model->prepare(1);
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
          fullTangent<D>(v.model->shared(state, Order::TANGENT), exact));
      indefinite += eigen.eigenvalues()(0) < 0 ? 1 : 0;
      const Eigen::MatrixXd clamped =
          eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() * eigen.eigenvectors().transpose();
      EXPECT_LT((Eigen::MatrixXd(fullTangent<D>(v.model->shared(state, Order::PROJECTED), r)) - clamped).norm(),
                1e-9 * eigen.eigenvalues().cwiseAbs().maxCoeff())
          << v.name;
    }
  }
  EXPECT_GT(indefinite, 5) << "no indefinite tangent among the trials: nothing was tested";
}

/// Points side by side have the bits that each has alone: solid, grey and void, inverted ones among them.
template <int D>
void checkLanes(const Laws<D>& laws) {
  std::mt19937 rng(13);
  int infinite = 0;
  for (const auto& v : laws) {
    if (!v.model->inLanes(Order::TANGENT)) continue;
    for (int trial = 0; trial < 50; ++trial) {
      PointLanes<D> points;
      std::vector<Response<D>> alone(LANES);
      std::vector<bool> good(LANES);
      for (int l = 0; l < LANES; ++l) {
        const Matrix<D> f = Matrix<D>::Identity() + randomMatrix<D>(rng, std::pow(10, -(l + trial) % 9) * 1.5);
        const auto cell = v.model->prepare(DENSITIES[(l + trial) % 4]);
        for (int k = 0; k < D * D; ++k) points.h[k].at[l] = Matrix<D>(f - Matrix<D>::Identity()).data()[k];
        points.stiffness.at[l] = cell.stiffness;
        points.mix.at[l] = cell.mix;
        good[l] = v.model->evaluatePrepared(f, cell, Order::TANGENT, alone[l]);
      }
      ResponseLanes<D> r;
      v.model->evaluateLanes(points, r);
      for (int l = 0; l < LANES; ++l) {
        EXPECT_EQ(r.det_f.at[l], alone[l].det_f) << v.name;
        EXPECT_EQ(std::isfinite(r.energy.at[l]), good[l]) << v.name;
        infinite += good[l] ? 0 : 1;
        if (!good[l]) continue;
        EXPECT_EQ(r.energy.at[l], alone[l].energy) << v.name;
        EXPECT_EQ(r.b.at[l], alone[l].tangent.b) << v.name;
        EXPECT_EQ(r.c.at[l], alone[l].tangent.c) << v.name;
        for (int k = 0; k < D * D; ++k) {
          EXPECT_EQ(r.stress[k].at[l], alone[l].stress.data()[k]) << v.name;
          EXPECT_EQ(r.q[k].at[l], alone[l].tangent.q.data()[k]) << v.name;
        }
      }
    }
  }
  EXPECT_GT(infinite, 10) << "no inverted point among the trials";
}

template <int D>
void checkLaws(const Laws<D>& laws) {
  checkAtRest<D>(laws);
  checkDerivatives<D>(laws);
  checkDensityDerivatives<D>(laws);
  checkRotation<D>(laws);
  checkProjection<D>(laws);
}

}  // namespace snapwing::elasticity
