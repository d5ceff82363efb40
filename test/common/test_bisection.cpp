// Zeros by sign: within, and at the ends, whichever way the function leaves them.
#include <gtest/gtest.h>

#include <cmath>

#include "snapwing/common/bisection.h"

namespace snapwing::common {
namespace {

TEST(Bisection, FindsAZeroOfEitherSlope) {
  EXPECT_NEAR(bisect([](double x) { return x * x - 2; }, 0.0, 2.0, 60), std::sqrt(2.0), 1e-15);
  EXPECT_NEAR(bisect([](double x) { return 2 - x * x; }, 0.0, 2.0, 60), std::sqrt(2.0), 1e-15);
}

TEST(Bisection, FindsAZeroAtAnEnd) {
  for (const double sign : {1.0, -1.0}) {
    EXPECT_NEAR(bisect([&](double x) { return sign * x; }, 0.0, 1.0, 60), 0.0, 1e-15);
    EXPECT_NEAR(bisect([&](double x) { return sign * (x - 1); }, 0.0, 1.0, 60), 1.0, 1e-15);
  }
  EXPECT_NEAR(bisect([](double x) { return -0.0 * x; }, 0.0, 1.0, 60), 0.0, 1.0) << "no sign at all: still within";
}

TEST(Bisection, EndsAtTheWidthThatIsAskedFor) {
  int calls = 0;
  const double zero = bisect([&](double x) { return ++calls, x - 0.3; }, 0.0, 1.0, 60, 1e-3);
  EXPECT_NEAR(zero, 0.3, 1e-3);
  EXPECT_LE(calls, 12);
}

TEST(Bisection, NarrowsAnAnswerFromNoToYesAndAsksNoEnd) {
  const auto is = [](double x) {
    EXPECT_GT(x, 0);
    EXPECT_LT(x, 1);
    return x >= 0.3;
  };
  const Bracket found = bisect(Bracket{0, 1}, is, 60, 1e-3);
  EXPECT_LT(found.low, 0.3);
  EXPECT_GE(found.high, 0.3);
  EXPECT_LE(found.high - found.low, 1e-3);
  EXPECT_EQ(bisect(Bracket{0, 1}, is, 2).high, 0.5) << "0 .. 1, 0 .. 0.5, 0.25 .. 0.5";
  EXPECT_EQ(bisect(Bracket{0, 1}, is, 2).low, 0.25);
}

}  // namespace
}  // namespace snapwing::common
