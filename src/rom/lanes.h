// Eight numbers side by side, one per vehicle, as native vectors of the compiler. Included once for each width of
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
};
struct Index {
  IndexPart part[PARTS];
};
struct Real {
  RealPart part[PARTS];
  Real() = default;
  __attribute__((always_inline)) Real(double value) { SNAPWING_EACH part[i] = value - RealPart{}; }
  __attribute__((always_inline)) Real(const EightReals& from) {
    for (int i = 0; i < PARTS; ++i) {
      for (int l = 0; l < NATIVE; ++l) part[i][l] = from.lane[i * NATIVE + l];
    }
  }
  void store(EightReals* to) const {
    for (int l = 0; l < LANES; ++l) to->lane[l] = part[l / NATIVE][l % NATIVE];
  }
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
  long long found = bits[0];
  for (int l = 1; l < NATIVE; ++l) found |= bits[l];
  return found != 0;
}
SNAPWING_LANES bool all(const Mask& mask) { return !any(~mask); }
SNAPWING_LANES Real root(const Real& a) {
  Real r;
  for (int i = 0; i < PARTS; ++i) {
    for (int l = 0; l < NATIVE; ++l) r.part[i][l] = __builtin_sqrt(a.part[i][l]);
  }
  return r;
}

/// Element `at` of `base` for every lane. Built in registers: lanes that are stored one by one and read as a vector
/// would wait for memory.
SNAPWING_LANES Real pick(const double* base, const Index& at) {
  Real r;
  for (int i = 0; i < PARTS; ++i) {
    const IndexPart& n = at.part[i];
#if SNAPWING_NATIVE == 8
    r.part[i] =
        RealPart{base[n[0]], base[n[1]], base[n[2]], base[n[3]], base[n[4]], base[n[5]], base[n[6]], base[n[7]]};
#elif SNAPWING_NATIVE == 4
    r.part[i] = RealPart{base[n[0]], base[n[1]], base[n[2]], base[n[3]]};
#else
    r.part[i] = RealPart{base[n[0]], base[n[1]]};
#endif
  }
  return r;
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
SNAPWING_LANES Index operator+(const Index& a, const Index& b) {
  Index r;
  SNAPWING_EACH r.part[i] = a.part[i] + b.part[i];
  return r;
}
SNAPWING_LANES Index shifted(const Index& a, int by) {
  Index r;
  SNAPWING_EACH r.part[i] = a.part[i] + by;
  return r;
}

}  // namespace snapwing::rom::SNAPWING_WIDTH
