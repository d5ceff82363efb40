#include <gtest/gtest.h>

#include <cmath>

#include "snapwing/planning/uncertainty_points.h"

namespace snapwing::planning {
namespace {

TEST(UncertaintyPoints, SobolFillsTheBoxEvenly) {
  const int n = 17, count = 512;
  const auto points = sobolPoints(n, count, 1);
  ASSERT_EQ(points.size(), 512u);
  for (int j = 0; j < n; ++j) {
    double mean = 0, square = 0;
    for (const auto& p : points) {
      ASSERT_GE(p[j], -1.0);
      ASSERT_LT(p[j], 1.0);
      mean += p[j] / count;
      square += p[j] * p[j] / count;
    }
    EXPECT_NEAR(mean, 0.0, 0.02) << j;  // a random sample would miss by .026 typically
    EXPECT_NEAR(square, 1.0 / 3.0, 0.02) << j;
  }
}

TEST(UncertaintyPoints, DisjointRangesGiveOtherPoints) {
  const auto a = sobolPoints(3, 10, 1), b = sobolPoints(3, 10, 11), all = sobolPoints(3, 20, 1);
  EXPECT_NE(a[0], b[0]);
  EXPECT_EQ(all[3], a[3]);
  EXPECT_EQ(all[13], b[3]);
}

TEST(UncertaintyPoints, AxesAndCorners) {
  const auto axes = axisPoints(3);
  ASSERT_EQ(axes.size(), 6u);
  EXPECT_EQ(axes[2], (BoxPoint{0, -1, 0}));
  EXPECT_EQ(axes[3], (BoxPoint{0, 1, 0}));
  const auto corners = cornerPoints(3, {2, 0});
  ASSERT_EQ(corners.size(), 4u);
  EXPECT_EQ(corners[0], (BoxPoint{-1, 0, -1}));
  EXPECT_EQ(corners[1], (BoxPoint{-1, 0, 1}));
  EXPECT_EQ(cornerPoints(3, {}).size(), 1u);
}

}  // namespace
}  // namespace snapwing::planning
