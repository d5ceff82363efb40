#pragma once
/// Elementary functions whose bits depend neither on the processor nor on the C library: that one chooses among
/// variants with and without fused multiply-add, and its versions differ. Errors stay below one unit in the last place.
/// NaN gives NaN. Designs are made with these alone.

#include <cstdint>
#include <cstring>

namespace snapwing::common {

double exp(double x);
double expm1(double x);  ///< e^x - 1
double log(double x);
double log1p(double x);  ///< ln(1 + x)
double tanh(double x);
/// @param base  >= 0; below: NaN
double pow(double base, double exponent);
/// @param angle  [rad], |angle| <= 1e8; beyond: NaN
double sin(double angle);
double cos(double angle);
/// Angle of (x, y) from the x axis [rad], -pi .. pi; of (0, 0): 0.
double atan2(double y, double x);
double hypot(double x, double y);

/// ln(1 + x), and what x has beyond it: x - ln(1 + x), without cancellation at small x.
struct LogOnePlus {
  double value, beyond;
};
/// e^x - 1, and what it has beyond x: e^x - 1 - x, without cancellation at small x.
struct ExpLessOne {
  double value, beyond;
};

// What laws need in their innermost loops. Without branches and calls: the compiler evaluates several points side by
// side, and each has the bits that it has alone.

/// @param x  > -1, finite
inline LogOnePlus logOnePlus(double x);
/// @param x  |x| <= 700
inline ExpLessOne expLessOne(double x);

namespace elementary {

constexpr double LN2_HIGH = 0x1.62e42fee00000p-1;  ///< 32 bits: whole multiples are exact
constexpr double LN2_LOW = 0x1.a39ef35793c76p-33;
constexpr double ROUNDER = 0x1.8p52;  ///< added and taken away: the nearest whole number, in the last bits of the sum
constexpr std::uint64_t ONE_BITS = 0x3ff0000000000000, HALF_ROOT_BITS = 0x3fe6a09e667f3bcd;  // of sqrt(1/2)
constexpr double BIAS = 1024;

inline std::uint64_t bitsOf(double x) {
  std::uint64_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  return bits;
}
inline double fromBits(std::uint64_t bits) {
  double x;
  std::memcpy(&x, &bits, sizeof x);
  return x;
}

/// x = 2^k m, sqrt(1/2) <= m < sqrt(2), from the bits of a normal x > 0: k + BIAS, and with it m.
inline std::uint64_t biasedExponent(std::uint64_t bits) {
  return (bits - HALF_ROOT_BITS + (std::uint64_t{1024} << 52)) >> 52;
}
inline double withoutExponent(std::uint64_t bits, std::uint64_t biased) {
  return fromBits(bits - (biased << 52) + (std::uint64_t{1024} << 52));
}

/// ln of 2^power (1 + f) (1 + c), sqrt(1/2) <= 1 + f <= sqrt(2), c a rounding: ln(1 + f) = 2 artanh(s), s = f / (2 +
/// f). `beyond` is f - ln(1 + f), whatever the power.
inline LogOnePlus logFrom(double power, double f, double c) {
  const double s = f / (2 + f), z = s * s, z2 = z * z, z4 = z2 * z2, half = 0.5 * f * f;
  const double low = (2 / 3. + 2 / 5. * z) + (2 / 7. + 2 / 9. * z) * z2;
  const double high = (2 / 11. + 2 / 13. * z) + (2 / 15. + 2 / 17. * z) * z2 + (2 / 19. + 2 / 21. * z) * z4;
  const double series = z * (low + z4 * high), beyond = half - s * (half + series);
  return {power * LN2_HIGH + (f - (beyond - (c + power * LN2_LOW))), beyond};
}

/// e^(r + c) - 1 - r for |r| <= ln(2) / 2 and a rounding c.
inline double expTail(double r, double c) {
  const double r2 = r * r, r4 = r2 * r2;
  const double low = (1 / 2. + 1 / 6. * r) + (1 / 24. + 1 / 120. * r) * r2;
  const double middle = (1 / 720. + 1 / 5040. * r) + (1 / 40320. + 1 / 362880. * r) * r2;
  const double high = (1 / 3628800. + 1 / 39916800. * r) + (1 / 479001600. + 1 / 6227020800. * r) * r2;
  return r2 * (low + r4 * (middle + r4 * high)) + (c + c * r);
}

/// x = whole ln(2) + r + c, |r| <= ln(2) / 2.
struct ExpArgument {
  explicit ExpArgument(double x) {
    const double shifted = x * 0x1.71547652b82fep+0 + ROUNDER;
    whole = shifted - ROUNDER;
    const double high = x - whole * LN2_HIGH, low = whole * LN2_LOW;
    r = high - low;
    c = (high - r) - low;
    two_to_whole = fromBits((bitsOf(shifted) << 52) + ONE_BITS);
  }
  double whole, r, c;
  double two_to_whole;  ///< 2^whole, for |whole| <= 1022
};

}  // namespace elementary

inline LogOnePlus logOnePlus(double x) {
  using namespace elementary;
  const double u = 1 + x, less = u - x, lost = (1 - less) + (x - (u - less));  // 1 + x = u + lost
  const std::uint64_t bits = bitsOf(u), biased = biasedExponent(bits);
  // A whole number as a double by the bits of a sum: a conversion would not be done side by side.
  const double power = fromBits(bitsOf(ROUNDER) + biased) - (ROUNDER + BIAS), m = withoutExponent(bits, biased);
  const bool whole = power == 0;
  const LogOnePlus r = logFrom(power, whole ? x : m - 1, whole ? 0 : lost / u);
  return {r.value, whole ? r.beyond : x - r.value};
}

inline ExpLessOne expLessOne(double x) {
  using namespace elementary;
  const ExpArgument a(x);
  const double tail = expTail(a.r, a.c), two = a.two_to_whole;
  const double first = two - 1, second = two * a.r, sum = first + second, part = sum - first;
  const double lost = ((two - first) - 1) + ((first - (sum - part)) + (second - part));
  const double value = sum + (lost + two * tail);
  return {value, a.whole == 0 ? tail : value - x};
}

}  // namespace snapwing::common
