#include "law_battery.h"
#include "law_series.h"
#include "snapwing/common/error.h"
#include "snapwing/elasticity/saint_venant_kirchhoff.h"

namespace snapwing::elasticity {
namespace {

template <int D>
Laws<D> variants() {
  Laws<D> list{{"whole", std::make_shared<SaintVenantKirchhoff<D>>(TPU, DensityInterpolation())}};
  if (D == 2) {
    list.push_back(
        {"plane stress", std::make_shared<SaintVenantKirchhoff<D>>(TPU, DensityInterpolation(), Plane::STRESS)});
  }
  return list;
}

TEST(SaintVenantKirchhoff, GoesThroughTheBattery) {
  checkLaws<2>(variants<2>());
  checkLaws<3>(variants<3>());
  checkSeries<2>(variants<2>());
  checkSeries<3>(variants<3>());
}

/// A bar pulled to l times its length in plane stress, free to the sides: P = E (l^3 - l) / 2.
TEST(SaintVenantKirchhoff, PullsAsTheClosedFormSays) {
  const SaintVenantKirchhoff<2> law(TPU, {}, Plane::STRESS);
  for (const double l : {0.8, 1.0, 1.3}) {
    const double strain = 0.5 * (l * l - 1);
    Matrix<2> f = Matrix<2>::Zero();
    f(0, 0) = l;
    f(1, 1) = std::sqrt(1 - 2 * TPU.poisson_ratio * strain);
    Response<2> r;
    ASSERT_TRUE(law.evaluate(f, 1, Order::STRESS, r));
    EXPECT_NEAR(r.stress(0, 0), 0.5 * TPU.youngs_modulus * (l * l * l - l), 1e-9 * TPU.youngs_modulus);
    EXPECT_NEAR(r.stress(1, 1), 0, 1e-9 * TPU.youngs_modulus);
  }
  EXPECT_THROW(SaintVenantKirchhoff<2>({-1, 0.3, 0}, {}), common::Error);
}

}  // namespace
}  // namespace snapwing::elasticity
