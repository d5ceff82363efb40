// Own elementary functions against long double, whose 64 bits leave eleven beyond a double's.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "snapwing/common/elementary.h"

namespace snapwing::common {
namespace {

constexpr double INFINITE = std::numeric_limits<double>::infinity();
constexpr double NOT_A_NUMBER = std::numeric_limits<double>::quiet_NaN();
constexpr int DRAWS = 200000;

/// Distance in units of the last place that a double has at the truth.
double unitsOff(double found, long double truth) {
  if (static_cast<double>(truth) == found) return 0;
  int exponent = 0;
  std::frexp(truth, &exponent);
  const long double unit = std::ldexp(1.0L, std::max(exponent - 53, -1074));
  return static_cast<double>(std::abs(static_cast<long double>(found) - truth) / unit);
}

struct Draw {
  std::mt19937_64 rng{11};
  /// Evenly in an interval, or evenly in the exponent of a size.
  double even(double low, double high) { return std::uniform_real_distribution<double>(low, high)(rng); }
  double size(double low, double high) { return std::exp2(even(std::log2(low), std::log2(high))); }
  double sign() { return rng() % 2 == 0 ? 1 : -1; }
};

using Function = std::function<double(double)>;
using Truth = std::function<long double(long double)>;

void expectExact(const Function& f, const Truth& truth, const std::function<double(Draw&)>& argument) {
  Draw draw;
  double worst = 0, where = 0;
  for (int k = 0; k < DRAWS; ++k) {
    const double x = argument(draw), off = unitsOff(f(x), truth(x));
    if (!(off <= worst)) worst = off, where = x;
  }
  EXPECT_LT(worst, 1) << "at " << where;
}

TEST(Elementary, Exponential) {
  const Truth truth = [](long double x) { return std::exp(x); };
  expectExact(common::exp, truth, [](Draw& d) { return d.even(-745, 709.7); });
  expectExact(common::exp, truth, [](Draw& d) { return d.sign() * d.size(1e-20, 3); });
}

TEST(Elementary, ExponentialLessOne) {
  const Truth truth = [](long double x) { return std::expm1(x); };
  expectExact(common::expm1, truth, [](Draw& d) { return d.even(-60, 709.7); });
  expectExact(common::expm1, truth, [](Draw& d) { return d.even(-1.2, 1.2); });
  expectExact(common::expm1, truth, [](Draw& d) { return d.sign() * d.size(1e-300, 3); });
}

TEST(Elementary, Logarithm) {
  const Truth truth = [](long double x) { return std::log(x); };
  expectExact(common::log, truth, [](Draw& d) { return d.size(1e-307, 1e308); });
  expectExact(common::log, truth, [](Draw& d) { return d.even(0.3, 3); });
  expectExact(common::log, truth, [](Draw& d) { return d.size(0x1p-1074, 0x1p-1022); });
}

TEST(Elementary, LogarithmOfOnePlus) {
  const Truth truth = [](long double x) { return std::log1p(x); };
  expectExact(common::log1p, truth, [](Draw& d) { return d.even(-0.999, 3); });
  expectExact(common::log1p, truth, [](Draw& d) { return d.sign() * d.size(1e-300, 0.9); });
  expectExact(common::log1p, truth, [](Draw& d) { return d.size(1e-3, 1e308); });
  expectExact(common::log1p, truth, [](Draw& d) { return -1 + d.size(0x1p-53, 1); });
}

/// Small differences are what a line search compares: they keep their digits.
TEST(Elementary, WhatIsBeyondKeepsItsDigits) {
  Draw draw;
  for (int k = 0; k < DRAWS; ++k) {
    const double x = draw.sign() * draw.size(1e-12, 0.25);
    long double log_beyond = 0, exp_beyond = 0, power = static_cast<long double>(x) * x, factorial = 2;
    for (int n = 2; n < 60; ++n, power *= x, factorial *= n) {
      log_beyond += (n % 2 == 0 ? power : -power) / n;
      exp_beyond += power / factorial;
    }
    EXPECT_LT(unitsOff(logOnePlus(x).beyond, log_beyond), 4) << x;
    EXPECT_LT(unitsOff(expLessOne(x).beyond, exp_beyond), 4) << x;
  }
}

TEST(Elementary, HyperbolicTangent) {
  const Truth truth = [](long double x) { return std::tanh(x); };
  expectExact(common::tanh, truth, [](Draw& d) { return d.even(-25, 25); });
  expectExact(common::tanh, truth, [](Draw& d) { return d.sign() * d.size(1e-300, 2); });
}

TEST(Elementary, Power) {
  Draw draw;
  double worst = 0;
  for (int k = 0; k < DRAWS; ++k) {
    const bool design = k % 2 == 0;  // densities to their power, else anything up to the ends of the range
    const double x = design ? draw.even(0, 1) : draw.size(1e-300, 1e300);
    const double y = design ? draw.even(1, 10) : draw.even(-700, 700) / std::log(x);
    worst = std::max(worst, unitsOff(common::pow(x, y), std::pow(static_cast<long double>(x), y)));
  }
  EXPECT_LT(worst, 1);
}

TEST(Elementary, SineAndCosine) {
  const Truth sine = [](long double x) { return std::sin(x); }, cosine = [](long double x) { return std::cos(x); };
  for (const double most : {1.0, 10.0, 1e8}) {
    const auto angle = [most](Draw& d) { return d.even(-most, most); };
    expectExact(common::sin, sine, angle);
    expectExact(common::cos, cosine, angle);
  }
  expectExact(common::sin, sine, [](Draw& d) { return d.sign() * d.size(1e-300, 1); });
  // Beside whole quarters, where nearly all digits cancel.
  const auto quarter = [](Draw& d) { return std::floor(d.even(0, 6e7)) * 1.5707963267948966; };
  expectExact(common::sin, sine, quarter);
  expectExact(common::cos, cosine, quarter);
}

TEST(Elementary, AngleAndLength) {
  Draw draw;
  double angle = 0, length = 0;
  for (int k = 0; k < DRAWS; ++k) {
    const bool wide = k % 2 == 0;
    const auto number = [&] { return draw.sign() * (wide ? draw.size(1e-300, 1e300) : draw.even(0, 1)); };
    const double x = number(), y = number();
    angle = std::max(angle, unitsOff(common::atan2(y, x), std::atan2(static_cast<long double>(y), x)));
    length = std::max(length, unitsOff(common::hypot(x, y), std::hypot(static_cast<long double>(x), y)));
  }
  EXPECT_LT(angle, 1);
  EXPECT_LT(length, 1);
}

/// Where the C library's answer is exact or agreed on, ours is the same.
TEST(Elementary, SpecialValuesAreThoseOfTheLibrary) {
  const auto same = [](double a, double b) {
    return (std::isnan(a) && std::isnan(b)) || (a == b && std::signbit(a) == std::signbit(b));
  };
  const std::vector<double> values = {0.0, -0.0,   1.0,   -1.0,      2.0,          0.5,    INFINITE,
                                      3.0, 1e-320, 1e308, -INFINITE, NOT_A_NUMBER, -745.2, 709.8};
  for (const double x : values) {
    EXPECT_TRUE(same(common::exp(x), std::exp(x)) || unitsOff(common::exp(x), std::exp(x)) <= 1) << x;
    EXPECT_TRUE(same(common::tanh(x), std::tanh(x)) || unitsOff(common::tanh(x), std::tanh(x)) <= 1) << x;
    EXPECT_TRUE(same(common::expm1(x), std::expm1(x)) || unitsOff(common::expm1(x), std::expm1(x)) <= 1) << x;
    EXPECT_TRUE(same(common::log(x), std::log(x)) || unitsOff(common::log(x), std::log(x)) <= 1) << x;
    EXPECT_TRUE(same(common::log1p(x), std::log1p(x)) || unitsOff(common::log1p(x), std::log1p(x)) <= 1) << x;
    for (const double y : values) {
      if (x >= 0 && !std::signbit(x)) {
        EXPECT_TRUE(same(common::pow(x, y), std::pow(x, y)) || unitsOff(common::pow(x, y), std::pow(x, y)) <= 1)
            << x << " " << y;
      }
      EXPECT_TRUE(same(common::hypot(x, y), std::hypot(x, y)) || unitsOff(common::hypot(x, y), std::hypot(x, y)) <= 1)
          << x << " " << y;
      if (x == 0 && y == 0) continue;  // ours is 0 for either sign
      EXPECT_TRUE(same(common::atan2(y, x), std::atan2(y, x)) || unitsOff(common::atan2(y, x), std::atan2(y, x)) <= 1)
          << x << " " << y;
    }
  }
  EXPECT_TRUE(std::isnan(common::pow(-1, 2)));
  EXPECT_TRUE(std::isnan(common::sin(2e8)));
  EXPECT_TRUE(std::isnan(common::cos(INFINITE)));
  EXPECT_EQ(common::pow(0.5, 3), 0.125);
  EXPECT_EQ(common::pow(9, 0.5), 3);
}

}  // namespace
}  // namespace snapwing::common
