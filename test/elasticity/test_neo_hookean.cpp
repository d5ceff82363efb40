#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "snapwing/common/error.h"
#include "snapwing/elasticity/neo_hookean.h"
#include "support/derivative_check.h"

namespace snapwing::elasticity {
namespace {

const Material TPU{5.5e6, 0.48, 1210};

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
};

template <int D>
std::vector<Variant<D>> variants() {
  const DensityInterpolation i;
  std::vector<Variant<D>> list;
  const auto add = [&](const char* name, Plane plane, Part part) {
    list.push_back({name, std::make_shared<NeoHookean<D>>(TPU, i, plane, part)});
  };
  add("whole", Plane::STRAIN, Part::ALL);
  add("shear", Plane::STRAIN, Part::SHEAR);
  add("volume", Plane::STRAIN, Part::VOLUME);
  if (D == 2) add("plane stress", Plane::STRESS, Part::ALL);
  return list;
}

/// Densities: solid, in between, and where the void's linear energy takes over (rho^3 near the threshold .01).
constexpr double DENSITIES[] = {1.0, 0.6, 0.215, 0.1};

template <int D>
void checkAtRest() {
  for (const auto& v : variants<D>()) {
    for (const double rho : DENSITIES) {
      Response<D> r;
      ASSERT_TRUE(v.model->evaluate(Matrix<D>::Identity(), rho, Order::TANGENT, r)) << v.name;
      EXPECT_NEAR(r.energy, 0, 1e-9) << v.name;
      if (v.name == "whole" || v.name == "plane stress") {
        EXPECT_NEAR(r.stress.norm(), 0, 1e-7) << v.name;
      }
      EXPECT_EQ(r.det_f, 1) << v.name;
    }
  }
}

template <int D>
void checkDerivatives() {
  std::mt19937 rng(7);
  for (const auto& v : variants<D>()) {
    for (const double rho : DENSITIES) {
      const Matrix<D> f = randomGradient<D>(rng), direction = randomMatrix<D>(rng, 1);
      Response<D> r;
      ASSERT_TRUE(v.model->evaluate(f, rho, Order::TANGENT, r));
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
                                          vec<D>(r.tangent.times(direction)), 1, 1e-7))
          << v.name << " tangent at density " << rho;
      const FullTangent<D> full = r.tangent.full();
      EXPECT_LT((full - full.transpose()).norm(), 1e-12 * full.norm()) << v.name;
      EXPECT_LT((full * vec<D>(direction) - vec<D>(r.tangent.times(direction))).norm(),
                1e-12 * full.norm() * direction.norm());
    }
  }
}

template <int D>
void checkDensityDerivatives() {
  std::mt19937 rng(11);
  for (const auto& v : variants<D>()) {
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
void checkRotation() {
  std::mt19937 rng(5);
  const Matrix<D> f = randomGradient<D>(rng);
  const Matrix<D> q = Eigen::HouseholderQR<Matrix<D>>(randomMatrix<D>(rng, 1)).householderQ();
  const Matrix<D> rotation = q.determinant() > 0 ? q : Matrix<D>(-q.col(0) * Matrix<D>::Identity().row(0) * 2 + q);
  const Matrix<D> turn = rotation.determinant() > 0 ? rotation : Matrix<D>::Identity();
  for (const auto& v : variants<D>()) {
    Response<D> still, turned;
    ASSERT_TRUE(v.model->evaluate(f, 1, Order::STRESS, still));
    ASSERT_TRUE(v.model->evaluate(turn * f, 1, Order::STRESS, turned));
    EXPECT_NEAR(turned.energy, still.energy, 1e-12 * (std::abs(still.energy) + TPU.youngs_modulus)) << v.name;
    EXPECT_LT((turned.stress - turn * still.stress).norm(), 1e-9 * TPU.youngs_modulus) << v.name;
  }
}

/// The projected tangent equals the eigenvalue clamp of the exact one, found by a general eigensolver.
template <int D>
void checkProjection() {
  std::mt19937 rng(3);
  int indefinite = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const Matrix<D> f = randomGradient<D>(rng) * (trial % 2 ? 0.75 : 1.0);
    for (const auto& v : variants<D>()) {
      Response<D> r;
      ASSERT_TRUE(v.model->evaluate(f, 1, Order::PROJECTED, r));
      const Eigen::SelfAdjointEigenSolver<FullTangent<D>> eigen(r.tangent.full());
      indefinite += eigen.eigenvalues()(0) < 0 ? 1 : 0;
      const FullTangent<D> clamped =
          eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() * eigen.eigenvectors().transpose();
      EXPECT_LT((r.full - clamped).norm(), 1e-9 * eigen.eigenvalues().cwiseAbs().maxCoeff()) << v.name;
    }
  }
  EXPECT_GT(indefinite, 5) << "no indefinite tangent among the trials: nothing was tested";
}

TEST(NeoHookean, AtRestPlanar) { checkAtRest<2>(); }
TEST(NeoHookean, AtRestVolumetric) { checkAtRest<3>(); }
TEST(NeoHookean, DerivativesPlanar) { checkDerivatives<2>(); }
TEST(NeoHookean, DerivativesVolumetric) { checkDerivatives<3>(); }
TEST(NeoHookean, DensityDerivativesPlanar) { checkDensityDerivatives<2>(); }
TEST(NeoHookean, DensityDerivativesVolumetric) { checkDensityDerivatives<3>(); }
TEST(NeoHookean, RotationPlanar) { checkRotation<2>(); }
TEST(NeoHookean, RotationVolumetric) { checkRotation<3>(); }
TEST(NeoHookean, ProjectionPlanar) { checkProjection<2>(); }
TEST(NeoHookean, ProjectionVolumetric) { checkProjection<3>(); }

/// Plane strain is the solid with no stretch across; plane stress the solid whose P33 vanishes.
TEST(NeoHookean, PlanarLawsAgreeWithTheSolid) {
  std::mt19937 rng(2);
  const NeoHookean<3> solid(TPU, {});
  const NeoHookean<2> strain(TPU, {}), stress(TPU, {}, Plane::STRESS);
  for (int trial = 0; trial < 5; ++trial) {
    const Matrix<2> f = randomGradient<2>(rng);
    Matrix<3> whole = Matrix<3>::Identity();
    whole.topLeftCorner<2, 2>() = f;
    Response<2> planar;
    Response<3> spatial;
    ASSERT_TRUE(strain.evaluate(f, 1, Order::STRESS, planar));
    ASSERT_TRUE(solid.evaluate(whole, 1, Order::STRESS, spatial));
    EXPECT_NEAR(planar.energy, spatial.energy, 1e-9 * spatial.energy);
    // Thickness stretch by bisection on P33, which grows with it.
    double low = 1e-2, high = 1e2;
    for (int i = 0; i < 200; ++i) {
      whole(2, 2) = std::sqrt(low * high);
      ASSERT_TRUE(solid.evaluate(whole, 1, Order::STRESS, spatial));
      (spatial.stress(2, 2) < 0 ? low : high) = whole(2, 2);
    }
    ASSERT_TRUE(stress.evaluate(f, 1, Order::STRESS, planar));
    EXPECT_NEAR(planar.energy, spatial.energy, 1e-8 * spatial.energy);
    EXPECT_LT((planar.stress - spatial.stress.topLeftCorner<2, 2>()).norm(), 1e-6 * planar.stress.norm());
  }
}

/// Areas from .0025 to 1e80 of the old one (below that det F itself is rounding): the thickness stretch l of an equal
/// biaxial one s solves mu (l^2 - 1) + lambda ln(s^2 l) = 0, here by bisection on ln l; then P11 = mu s + (lambda
/// ln(s^2 l) - mu) / s.
TEST(NeoHookean, PlaneStressHoldsAtTheExtremes) {
  for (const double nu : {0.0, 0.3, 0.48, 0.4999}) {
    const Material material{TPU.youngs_modulus, nu, 0};
    const NeoHookean<2> law(material, {}, Plane::STRESS);
    const double mu = material.mu(), lambda = material.lambda();
    for (const double log_s : {-3.0, -0.1, -1e-3, -1e-7, 1e-7, 1e-3, 0.1, 3.0, 20.0, 92.0}) {
      long double low = -400, high = 400;
      for (int i = 0; i < 200; ++i) {
        const long double middle = 0.5L * (low + high);
        (mu * std::expm1(2 * middle) + lambda * (2 * log_s + middle) < 0 ? low : high) = middle;
      }
      const double s = std::exp(log_s);
      const double expected = mu * s + (lambda * (2 * log_s + static_cast<double>(low)) - mu) / s;
      const double terms = mu * s + (lambda * std::abs(2 * log_s) + mu) / s;
      Response<2> r;
      ASSERT_TRUE(law.evaluate(s * Matrix<2>::Identity(), 1, Order::TANGENT, r)) << nu << " " << log_s;
      EXPECT_NEAR(r.stress(0, 0), expected, 1e-13 * terms) << nu << " " << log_s;
      EXPECT_TRUE(std::isfinite(r.energy) && r.tangent.full().allFinite()) << nu << " " << log_s;
    }
  }
}

TEST(NeoHookean, SmallStrainGivesHooke) {
  // Uniaxial strain in plane stress: P11 = E/(1-nu^2) eps.
  const NeoHookean<2> law(TPU, {}, Plane::STRESS);
  Matrix<2> f = Matrix<2>::Identity();
  f(0, 0) += 1e-6;
  Response<2> r;
  ASSERT_TRUE(law.evaluate(f, 1, Order::STRESS, r));
  EXPECT_NEAR(r.stress(0, 0) / 1e-6, TPU.youngs_modulus / (1 - 0.48 * 0.48), 1e-5 * TPU.youngs_modulus);
}

TEST(NeoHookean, RefusesInvertedSolidButNotInvertedVoid) {
  const NeoHookean<2> law(TPU, {});
  Matrix<2> f = Matrix<2>::Identity();
  f(0, 0) = -0.5;
  Response<2> r;
  EXPECT_FALSE(law.evaluate(f, 1, Order::ENERGY, r));
  EXPECT_TRUE(law.evaluate(f, 0.01, Order::ENERGY, r));
}

TEST(NeoHookean, RefusesBadParameters) {
  const auto make = [](double e, double nu, DensityInterpolation i = {}) { NeoHookean<2> law({e, nu, 0}, i); };
  EXPECT_NO_THROW(make(1, 0.3));
  EXPECT_THROW(make(0, 0.3), common::Error);
  EXPECT_THROW(make(-1, 0.3), common::Error);
  EXPECT_THROW(make(std::nan(""), 0.3), common::Error);
  EXPECT_THROW(make(1, 0.5), common::Error);
  EXPECT_THROW(make(1, -0.1), common::Error);
  DensityInterpolation bad;
  bad.void_stiffness = 0;
  EXPECT_THROW(make(1, 0.3, bad), common::Error);
  EXPECT_THROW(NeoHookean<2>(TPU, {}, Plane::STRESS, Part::SHEAR), common::Error);
}

}  // namespace
}  // namespace snapwing::elasticity
