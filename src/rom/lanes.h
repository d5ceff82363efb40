// Numbers side by side, one per vehicle, as native vectors of the compiler. Included once for each width of
// vectors, with SNAPWING_WIDTH (a name) and SNAPWING_NATIVE (numbers in a native vector). Every operation is done lane
// by lane in the same order on every processor, and multiply and add are never fused (-ffp-contract=off): the bits do
// not depend on the machine. Private to the layer.
#pragma once

#include "ensemble_run.h"

namespace snapwing::rom::SNAPWING_WIDTH {

constexpr int NATIVE = SNAPWING_NATIVE, PARTS = LANES / NATIVE;
typedef double RealPart __attribute__((vector_size(8 * NATIVE)));
typedef long long MaskPart __attribute__((vector_size(8 * NATIVE)));
typedef int IndexPart __attribute__((vector_size(4 * NATIVE)));

#define SNAPWING_LANES static inline __attribute__((always_inline))
#define SNAPWING_EACH for (int i = 0; i < PARTS; ++i)

struct Mask {
  MaskPart part[PARTS];
  void set(int lane, bool value) { part[lane / NATIVE][lane % NATIVE] = value ? -1 : 0; }
  bool operator[](int lane) const { return part[lane / NATIVE][lane % NATIVE] != 0; }
};
struct Index {
  IndexPart part[PARTS];
};
struct Real {
  RealPart part[PARTS];
  Real() = default;
  __attribute__((always_inline)) Real(double value) { SNAPWING_EACH part[i] = value - RealPart{}; }
  Real(const LaneReals& from) {
    for (int l = 0; l < LANES; ++l) set(l, from.lane[l]);
  }
  void set(int lane, double value) { part[lane / NATIVE][lane % NATIVE] = value; }
  double operator[](int lane) const { return part[lane / NATIVE][lane % NATIVE]; }
};

#define SNAPWING_BINARY(RESULT, TYPE, OP)                           \
  SNAPWING_LANES RESULT operator OP(const TYPE& a, const TYPE& b) { \
    RESULT r;                                                       \
    SNAPWING_EACH r.part[i] = a.part[i] OP b.part[i];               \
    return r;                                                       \
  }
SNAPWING_BINARY(Real, Real, +)
SNAPWING_BINARY(Real, Real, -)
SNAPWING_BINARY(Real, Real, *)
SNAPWING_BINARY(Real, Real, /)
SNAPWING_BINARY(Mask, Real, <)
SNAPWING_BINARY(Mask, Real, <=)
SNAPWING_BINARY(Mask, Real, >)
SNAPWING_BINARY(Mask, Real, >=)
SNAPWING_BINARY(Mask, Real, ==)
SNAPWING_BINARY(Mask, Mask, &)
SNAPWING_BINARY(Mask, Mask, |)
SNAPWING_BINARY(Mask, Mask, ^)
#undef SNAPWING_BINARY

SNAPWING_LANES Mask operator~(const Mask& a) {
  Mask r;
  SNAPWING_EACH r.part[i] = ~a.part[i];
  return r;
}
SNAPWING_LANES Real operator-(const Real& a) {
  Real r;
  SNAPWING_EACH r.part[i] = -a.part[i];
  return r;
}
SNAPWING_LANES Mask same(const Mask& a, const Mask& b) { return ~(a ^ b); }
SNAPWING_LANES Mask none() {
  Mask r;
  SNAPWING_EACH r.part[i] = MaskPart{};
  return r;
}
SNAPWING_LANES Mask choose(const Mask& mask, const Mask& yes, const Mask& no) { return (mask & yes) | (~mask & no); }
SNAPWING_LANES Real select(const Mask& mask, const Real& yes, const Real& no) {
  Real r;
  SNAPWING_EACH r.part[i] = mask.part[i] ? yes.part[i] : no.part[i];
  return r;
}
SNAPWING_LANES Real least(const Real& a, const Real& b) { return select(a < b, a, b); }
SNAPWING_LANES Real most(const Real& a, const Real& b) { return select(a > b, a, b); }
SNAPWING_LANES Real clamp(const Real& value, const Real& low, const Real& high) {
  return least(most(value, low), high);
}
SNAPWING_LANES Real magnitude(const Real& a) {
  Real r;
  SNAPWING_EACH r.part[i] = (RealPart)((MaskPart)a.part[i] & 0x7fffffffffffffffLL);
  return r;
}
SNAPWING_LANES bool any(const Mask& m) {
  MaskPart bits = m.part[0];
  for (int i = 1; i < PARTS; ++i) bits |= m.part[i];
#if SNAPWING_NATIVE == 8
  bits |= __builtin_shufflevector(bits, bits, 4, 5, 6, 7, 0, 1, 2, 3);
  bits |= __builtin_shufflevector(bits, bits, 2, 3, 0, 1, 6, 7, 4, 5);
#elif SNAPWING_NATIVE == 4
  bits |= __builtin_shufflevector(bits, bits, 2, 3, 0, 1);
#endif
  return (bits[0] | bits[1]) != 0;
}
SNAPWING_LANES bool all(const Mask& mask) { return !any(~mask); }
SNAPWING_LANES Real root(const Real& a) {
  Real r;
  for (int i = 0; i < PARTS; ++i) {
    for (int l = 0; l < NATIVE; ++l) r.part[i][l] = __builtin_sqrt(a.part[i][l]);
  }
  return r;
}

/// The row `at` of every lane, by columns: a load for each lane and a transpose, which costs a third of look-ups one by
/// one. What is not used is not made.
SNAPWING_LANES void columns(const EightReals* table, const Index& at, Real (&out)[8]) {
  for (int i = 0; i < PARTS; ++i) {
    const IndexPart& n = at.part[i];
    const auto piece = [&](int lane, int which) {
      return *reinterpret_cast<const RealPart*>(table[n[lane]].at + which * NATIVE);
    };
#if SNAPWING_NATIVE == 8
    RealPart two[8], four[8];
    for (int k = 0; k < 8; k += 2) {
      const RealPart a = piece(k, 0), b = piece(k + 1, 0);
      two[k] = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
      two[k + 1] = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
    }
    for (int k = 0; k < 8; k += 4) {
      for (int j = 0; j < 2; ++j) {
        four[k + j] = __builtin_shufflevector(two[k + j], two[k + j + 2], 0, 1, 8, 9, 4, 5, 12, 13);
        four[k + j + 2] = __builtin_shufflevector(two[k + j], two[k + j + 2], 2, 3, 10, 11, 6, 7, 14, 15);
      }
    }
    for (int j = 0; j < 4; ++j) {
      out[j].part[i] = __builtin_shufflevector(four[j], four[j + 4], 0, 1, 2, 3, 8, 9, 10, 11);
      out[j + 4].part[i] = __builtin_shufflevector(four[j], four[j + 4], 4, 5, 6, 7, 12, 13, 14, 15);
    }
#elif SNAPWING_NATIVE == 4
    for (int h = 0; h < 2; ++h) {
      const RealPart a = piece(0, h), b = piece(1, h), c = piece(2, h), d = piece(3, h);
      const RealPart even = __builtin_shufflevector(a, b, 0, 4, 2, 6), odd = __builtin_shufflevector(a, b, 1, 5, 3, 7);
      const RealPart even2 = __builtin_shufflevector(c, d, 0, 4, 2, 6),
                     odd2 = __builtin_shufflevector(c, d, 1, 5, 3, 7);
      out[4 * h].part[i] = __builtin_shufflevector(even, even2, 0, 1, 4, 5);
      out[4 * h + 1].part[i] = __builtin_shufflevector(odd, odd2, 0, 1, 4, 5);
      out[4 * h + 2].part[i] = __builtin_shufflevector(even, even2, 2, 3, 6, 7);
      out[4 * h + 3].part[i] = __builtin_shufflevector(odd, odd2, 2, 3, 6, 7);
    }
#else
    for (int h = 0; h < 4; ++h) {
      const RealPart a = piece(0, h), b = piece(1, h);
      out[2 * h].part[i] = __builtin_shufflevector(a, b, 0, 2);
      out[2 * h + 1].part[i] = __builtin_shufflevector(a, b, 1, 3);
    }
#endif
  }
}
/// Whole part of a number, kept within 0 .. `largest`: what is no number must not read beyond a table.
SNAPWING_LANES Index whole(const Real& a, int largest) {
  Index r;
  SNAPWING_EACH {
    const IndexPart cut = __builtin_convertvector(a.part[i], IndexPart);
    const IndexPart capped = cut < largest ? cut : largest - IndexPart{};
    r.part[i] = capped > 0 ? capped : IndexPart{};
  }
  return r;
}
SNAPWING_LANES Real real(const Index& a) {
  Real r;
  SNAPWING_EACH r.part[i] = __builtin_convertvector(a.part[i], RealPart);
  return r;
}
SNAPWING_LANES Index operator*(const Index& a, int factor) {
  Index r;
  SNAPWING_EACH r.part[i] = a.part[i] * factor;
  return r;
}
/// exp(-a), a >= 0: to rounding up to 2, no less than exp(-16). Not the library's, whose bits depend on the processor.
SNAPWING_LANES Real decayed(const Real& a) {
  const Real q = least(a, Real(16.0)) * (1.0 / 8.0);
  Real e = Real(1.0);
  for (int k = 12; k > 0; --k) e = 1.0 - q * (1.0 / k) * e;
  e = e * e;
  e = e * e;
  return e * e;
}
SNAPWING_LANES Index operator+(const Index& a, const Index& b) {
  Index r;
  SNAPWING_EACH r.part[i] = a.part[i] + b.part[i];
  return r;
}

}  // namespace snapwing::rom::SNAPWING_WIDTH
