#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "law_battery.h"
#include "law_series.h"
#include "snapwing/common/error.h"
#include "snapwing/elasticity/neo_hookean.h"

namespace snapwing::elasticity {
namespace {

template <int D>
Laws<D> variants() {
  const DensityInterpolation i;
  Laws<D> list;
  const auto add = [&](const char* name, Plane plane, Part part) {
    list.push_back({name, std::make_shared<NeoHookean<D>>(TPU, i, plane, part), part == Part::ALL});
  };
  add("whole", Plane::STRAIN, Part::ALL);
  add("shear", Plane::STRAIN, Part::SHEAR);
  add("volume", Plane::STRAIN, Part::VOLUME);
  if (D == 2) add("plane stress", Plane::STRESS, Part::ALL);
  return list;
}

TEST(NeoHookean, AtRestPlanar) { checkAtRest<2>(variants<2>()); }
TEST(NeoHookean, AtRestVolumetric) { checkAtRest<3>(variants<3>()); }
TEST(NeoHookean, DerivativesPlanar) { checkDerivatives<2>(variants<2>()); }
TEST(NeoHookean, DerivativesVolumetric) { checkDerivatives<3>(variants<3>()); }
TEST(NeoHookean, DensityDerivativesPlanar) { checkDensityDerivatives<2>(variants<2>()); }
TEST(NeoHookean, DensityDerivativesVolumetric) { checkDensityDerivatives<3>(variants<3>()); }
TEST(NeoHookean, SeriesPlanar) { checkSeries<2>(variants<2>()); }
TEST(NeoHookean, SeriesVolumetric) { checkSeries<3>(variants<3>()); }
TEST(NeoHookean, RotationPlanar) { checkRotation<2>(variants<2>()); }
TEST(NeoHookean, RotationVolumetric) { checkRotation<3>(variants<3>()); }
TEST(NeoHookean, ProjectionPlanar) { checkProjection<2>(variants<2>()); }
TEST(NeoHookean, LanesPlanar) { checkLanes<2>(variants<2>()); }
TEST(NeoHookean, LanesVolumetric) { checkLanes<3>(variants<3>()); }
TEST(NeoHookean, ProjectionVolumetric) { checkProjection<3>(variants<3>()); }

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
      EXPECT_TRUE(std::isfinite(r.energy) && fullTangent<2>(law.shared(law.prepare(1), Order::TANGENT), r).allFinite())
          << nu << " " << log_s;
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
