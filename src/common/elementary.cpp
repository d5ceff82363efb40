#include "snapwing/common/elementary.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace snapwing::common {

using namespace elementary;

namespace {

constexpr double INFINITE = std::numeric_limits<double>::infinity();
constexpr double NOT_A_NUMBER = std::numeric_limits<double>::quiet_NaN();
constexpr double TWO_54 = 0x1p54;

/// A number as an unevaluated sum, with about twice the digits [Dekker 1971].
struct Twofold {
  double high = 0, low = 0;
};

/// a + b exactly.
Twofold sum(double a, double b) {
  const double s = a + b, part = s - a;
  return {s, (a - (s - part)) + (b - part)};
}

/// a b exactly, unless parts of it are too large or too small for a number. Without fused operations: halves of the
/// digits are multiplied.
Twofold product(double a, double b) {
  constexpr double SPLITTER = 134217729;  // 2^27 + 1
  const double sa = SPLITTER * a, sb = SPLITTER * b;
  const double a1 = sa - (sa - a), b1 = sb - (sb - b), a2 = a - a1, b2 = b - b1, p = a * b;
  return {p, ((a1 * b1 - p) + a1 * b2 + a2 * b1) + a2 * b2};
}

Twofold operator+(const Twofold& a, const Twofold& b) {
  const Twofold s = sum(a.high, b.high);
  return sum(s.high, s.low + (a.low + b.low));
}
Twofold operator*(const Twofold& a, const Twofold& b) {
  const Twofold p = product(a.high, b.high);
  return sum(p.high, p.low + (a.high * b.low + a.low * b.high));
}
Twofold operator/(const Twofold& a, const Twofold& b) {
  const double q = a.high / b.high;
  const Twofold p = product(q, b.high);
  return sum(q, (((a.high - p.high) - p.low) + a.low - q * b.low) / b.high);
}

/// x = 2^power m, sqrt(1/2) <= m < sqrt(2). @param x  > 0, finite
struct Normal {
  explicit Normal(double x) {
    const bool tiny = x < std::numeric_limits<double>::min();
    const std::int64_t bits = bitsOf(tiny ? x * TWO_54 : x);
    const std::uint64_t biased = biasedExponent(bits);
    m = withoutExponent(bits, biased);
    power = static_cast<double>(biased) - BIAS - (tiny ? 54 : 0);
  }
  double m, power;
};

/// What keeps squares and products of numbers up to this one away from the ends of the range.
double scaleOf(double large) { return large > 0x1p400 ? 0x1p-600 : large < 0x1p-400 ? 0x1p600 : 1; }

/// x 2^n, rounded once unless the result is subnormal.
double scaled(double x, double n) {
  const double half = std::floor(0.5 * n), rest = n - half;
  const auto two = [](double power) { return fromBits((static_cast<std::int64_t>(power) + 1023) << 52); };
  return x * two(half) * two(rest);
}

/// e^x to twice the digits' half, as a mantissa near 1 and a power of two. @param x  |x| <= 1000
Twofold expMantissa(const Twofold& x, double& power) {
  const ExpArgument a(x.high);
  power = a.whole;
  const Twofold s = sum(1, a.r);
  const double tail = expTail(a.r, a.c);
  return {s.high, s.low + (tail + x.low * (s.high + tail))};
}

double expOf(const Twofold& x) {
  if (x.high > 710) return INFINITE;
  if (x.high < -746) return 0;
  double power;
  const Twofold m = expMantissa(x, power);
  return scaled(m.high + m.low, power);
}

/// ln x to about 65 bits: 2 artanh(s) as a series in s, its two first terms twofold. @param x  > 0, finite
Twofold logTwofold(double x) {
  const Normal n(x);
  const double f = n.m - 1;
  const Twofold s = Twofold{f, 0} / sum(2, f), z = s * s;
  const double w = z.high, w2 = w * w, w4 = w2 * w2;
  const double low = (2 / 5. + 2 / 7. * w) + (2 / 9. + 2 / 11. * w) * w2;
  const double high = (2 / 13. + 2 / 15. * w) + (2 / 17. + 2 / 19. * w) * w2;
  const double highest = (2 / 21. + 2 / 23. * w) + (2 / 25. + 2 / 27. * w) * w2;
  const Twofold third = {0x1.5555555555555p-1, 0x1.5555555555555p-55};  // 2/3
  const Twofold series = s * (Twofold{2, 0} + z * (third + Twofold{w * (low + w4 * (high + w4 * highest)), 0}));
  return Twofold{n.power * LN2_HIGH, 0} + (product(n.power, LN2_LOW) + series);
}

/// e^x - 1 as an unevaluated sum. @param x  |x| <= 700
Twofold expLessOneTwofold(double x) {
  const ExpArgument a(x);
  const double two = a.two_to_whole;
  const Twofold first = sum(two, -1), s = sum(first.high, two * a.r);
  return sum(s.high, s.low + (first.low + two * expTail(a.r, a.c)));
}

/// angle = whole pi / 2 + r, |r.high| <= pi / 4. @param angle  |angle| <= 1e8
struct Quarter {
  explicit Quarter(double angle) {
    // Parts of 27 bits: whole multiples of them are exact.
    constexpr double FIRST = 0x1.921fb54p+0, SECOND = 0x1.10b461p-30, THIRD = 0x1.a62633p-58;
    constexpr double FOURTH = 0x1.45c06e0e68948p-86;
    const double whole = (angle * 0x1.45f306dc9c883p-1 + ROUNDER) - ROUNDER;
    r = sum(angle - whole * FIRST, -whole * SECOND) + sum(-whole * THIRD, -whole * FOURTH);
    number = static_cast<int>(static_cast<std::int64_t>(whole) & 3);
  }
  Twofold r;
  int number;
};

double sineNear(const Twofold& x) {
  const double r = x.high, z = r * r;
  double series = 0;
  for (int k = 17; k >= 3; k -= 2) series = -z / (k * (k - 1)) * (1 + series);
  return r + (r * series + x.low * (1 - 0.5 * z));
}

double cosineNear(const Twofold& x) {
  const double r = x.high, z = r * r, half = 0.5 * z, w = 1 - half;
  double series = 0;
  for (int k = 18; k >= 4; k -= 2) series = -z / (k * (k - 1)) * (1 + series);
  return w + (((1 - w) - half) + (-half * series - r * x.low));
}

double sineOf(double angle, int ahead) {
  if (!(std::abs(angle) <= 1e8)) return NOT_A_NUMBER;
  const Quarter q(angle);
  const int number = (q.number + ahead) & 3;
  const double value = number % 2 == 0 ? sineNear(q.r) : cosineNear(q.r);
  return number < 2 ? value : -value;
}

/// arctan of a ratio 0 .. 1: that of the nearest eighth from a table, and a series for the rest.
Twofold arctangent(const Twofold& ratio) {
  static constexpr Twofold EIGHTHS[] = {
      {0, 0},
      {0x1.fd5ba9aac2f6ep-4, -0x1.cd37686760c17p-59},
      {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
      {0x1.6f61941e4def1p-2, -0x1.c63aae6f6e918p-56},
      {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
      {0x1.1e00babdefeb4p-1, -0x1.928df287a668fp-58},
      {0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
      {0x1.700a7c5784634p-1, -0x1.8c34d25aadef6p-56},
      {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55},
  };
  const double eighths = (8 * ratio.high + ROUNDER) - ROUNDER, c = eighths / 8;
  const Twofold t = c == 0 ? ratio : (ratio + Twofold{-c, 0}) / (Twofold{1, 0} + Twofold{c, 0} * ratio);
  const double z = t.high * t.high;
  double series = 0;
  for (int k = 17; k >= 3; k -= 2) series = -z * (1. / k + series);
  return EIGHTHS[static_cast<int>(eighths)] + (t + Twofold{t.high * series, 0});
}

}  // namespace

double exp(double x) {
  if (std::isnan(x)) return x;
  return expOf({x, 0});
}

double expm1(double x) {
  if (x == 0 || std::isnan(x)) return x;
  if (x > 700) return exp(x);
  return x < -50 ? -1 : expLessOne(x).value;
}

double log(double x) {
  if (std::isnan(x) || x == INFINITE) return x;
  if (x <= 0) return x == 0 ? -INFINITE : NOT_A_NUMBER;
  const Normal n(x);
  return logFrom(n.power, n.m - 1, 0).value;
}

double log1p(double x) {
  if (x == 0 || std::isnan(x) || x == INFINITE) return x;
  if (x <= -1) return x == -1 ? -INFINITE : NOT_A_NUMBER;
  return logOnePlus(x).value;
}

double tanh(double x) {
  const double size = std::abs(x);
  if (size < 1e-8 || std::isnan(x)) return x;
  if (size > 22) return std::copysign(1, x);
  const Twofold grown = expLessOneTwofold(2 * size), t = grown / (Twofold{2, 0} + grown);
  return std::copysign(t.high, x);
}

double pow(double base, double exponent) {
  if (exponent == 0 || base == 1) return 1;
  if (std::isnan(base) || std::isnan(exponent) || base < 0) return NOT_A_NUMBER;
  const bool infinite = std::isinf(exponent);
  if (base == 0 || base == INFINITE || infinite) {
    return (base > 1) == (exponent > 0) ? INFINITE : 0;
  }
  const Twofold l = logTwofold(base);
  const double rough = exponent * l.high;
  if (!(std::abs(rough) <= 1000)) return rough > 0 ? INFINITE : 0;
  if (std::abs(rough) < 1e-20) return 1;
  const Twofold p = product(exponent, l.high);
  return expOf(sum(p.high, p.low + exponent * l.low));
}

double sin(double angle) { return angle == 0 ? angle : sineOf(angle, 0); }
double cos(double angle) { return sineOf(angle, 1); }

double atan2(double y, double x) {
  if (std::isnan(x) || std::isnan(y)) return NOT_A_NUMBER;
  const double a = std::abs(x), b = std::abs(y), large = std::max(a, b), small = std::min(a, b);
  if (large == 0) return 0;
  Twofold angle;
  if (small == large) {
    angle = arctangent({1, 0});
  } else if (small / large < 0x1p-200) {
    angle.high = small / large;
  } else {
    const double scale = scaleOf(large);
    angle = arctangent(Twofold{small * scale, 0} / Twofold{large * scale, 0});
  }
  constexpr Twofold STRAIGHT = {0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53};
  if (b > a) angle = Twofold{0.5 * STRAIGHT.high, 0.5 * STRAIGHT.low} + Twofold{-angle.high, -angle.low};
  if (x < 0) angle = STRAIGHT + Twofold{-angle.high, -angle.low};
  return std::copysign(angle.high + angle.low, y);
}

double hypot(double x, double y) {
  const double a = std::abs(x), b = std::abs(y);
  if (std::isinf(a) || std::isinf(b)) return INFINITE;
  if (std::isnan(a) || std::isnan(b)) return NOT_A_NUMBER;
  const double large = std::max(a, b);
  if (large == 0) return 0;
  const double scale = scaleOf(large);
  const double u = a * scale, v = b * scale;
  const Twofold squares = product(u, u) + product(v, v);
  const double root = std::sqrt(squares.high);
  const Twofold back = product(root, root);
  return (root + ((squares.high - back.high) + (squares.low - back.low)) / (2 * root)) / scale;
}

}  // namespace snapwing::common
