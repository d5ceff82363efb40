#pragma once
/// The arithmetic of a supernodal factor on one panel, compiled for several widths of vectors (internal to the layer).

#include <cstddef>
#include <vector>

#include "snapwing/common/wide.h"
#include "supernodal.h"

#define SNAPWING_INLINE inline __attribute__((always_inline))

namespace snapwing::solver::supernodal {

constexpr int WIDE = 4;           ///< columns of a tile
constexpr int LANES = 4;          ///< rows of the least tile: strides are multiples of it
constexpr int LARGEST_TILE = 16;  ///< rows
constexpr int MOST_TOGETHER = 4;  ///< right sides in one sweep

/// N doubles side by side, anywhere in memory.
template <int N>
struct Lanes {
  typedef double type __attribute__((vector_size(N * sizeof(double)), aligned(sizeof(double)), may_alias));
};
typedef Lanes<4>::type Four;

using Panel = SupernodalFactor::Panel;

/// Factorises a panel from which all before is subtracted. @param inverse  1 / diagonal
/// @return false if a pivot is not positive
bool eliminate(double* first, std::size_t stride, int columns, double* inverse);

/// Where a finished panel's rows are subtracted.
struct Target {
  double* values;
  std::size_t stride;
  const int* column;    ///< of the matrix, of each row that is one of the target's
  int first;            ///< column of the target
  const int* relative;  ///< place in the target of each row
};

/// Subtracts lower lower^T, its columns begin .. end. @param lower  the panel below its diagonal block
void subtract(const double* lower, std::size_t stride, int columns, int begin, int end, int below, const Target& to);

/// What all sweeps of a factor share.
struct Sweep {
  const std::vector<Panel>& panels;
  const double* inverses;
  const int* rows;
  std::size_t size;  ///< of a right side
  std::size_t room;  ///< of the work space of one right side
  double* work;
};
/// Right sides in, solutions out. @param values  of L; @param count  1 .. MOST_TOGETHER
void solve(const Sweep& sweep, const double* values, int count, double* x);
/// The same for one right side, with L rounded.
void solve(const Sweep& sweep, const float* values, double* x);

}  // namespace snapwing::solver::supernodal
