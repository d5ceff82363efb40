#include <algorithm>

#include "supernodal_kernels.h"

namespace snapwing::solver::supernodal {

namespace {

constexpr std::size_t LONG = 128;  ///< rows of a panel whose columns are prefetched

/// A sweep's room for each right side: the panel's part of it.
template <int R>
struct Parts {
  double* of[R];
};

typedef float FourShort __attribute__((vector_size(16), aligned(4), may_alias));

SNAPWING_INLINE void read(const double* at, Four& out) { out = *reinterpret_cast<const Four*>(at); }
SNAPWING_INLINE void read(const float* at, Four& out) {
  out = __builtin_convertvector(*reinterpret_cast<const FourShort*>(at), Four);
}

/// Asks for what the next block of columns needs at the same rows. The processor's own guess fails at each column's
/// end.
template <int C, class T>
SNAPWING_INLINE void prefetch(const T* column, std::ptrdiff_t stride, std::ptrdiff_t block) {
#pragma GCC unroll 4
  for (int c = 0; c < C; ++c) __builtin_prefetch(column + c * stride + block);
}

/// Solves with the C columns from j on and takes their share from the rows behind them.
/// @tparam AHEAD  columns are so long that it pays to prefetch the next block's
/// @tparam T  of L; all arithmetic is in double
template <int C, int R, bool AHEAD, class T>
SNAPWING_INLINE void forwardBlock(const T* first, std::size_t stride, int j, const double* inverse,
                                  const Parts<R>& part) {
  const T* column = first + j * stride;
  double f[R][C];
#pragma GCC unroll 4
  for (int s = 0; s < R; ++s) {
#pragma GCC unroll 4
    for (int c = 0; c < C; ++c) {
      double value = part.of[s][j + c];
#pragma GCC unroll 4
      for (int k = 0; k < c; ++k) value -= column[k * stride + j + c] * f[s][k];
      part.of[s][j + c] = f[s][c] = value * inverse[j + c];
    }
  }
  for (int i = j + C; C < LANES && i < j + LANES; ++i) {
    for (int s = 0; s < R; ++s) {
      for (int c = 0; c < C; ++c) part.of[s][i] -= column[c * stride + i] * f[s][c];
    }
  }
  for (int i = j + LANES; i < static_cast<int>(stride); i += LANES) {
    if (AHEAD) prefetch<C>(column + i, static_cast<std::ptrdiff_t>(stride), static_cast<std::ptrdiff_t>(WIDE * stride));
    Four rows[C];
#pragma GCC unroll 4
    for (int c = 0; c < C; ++c) read(column + c * stride + i, rows[c]);
#pragma GCC unroll 4
    for (int s = 0; s < R; ++s) {
      Four& to = *reinterpret_cast<Four*>(part.of[s] + i);
      Four sum = rows[0] * f[s][0];
#pragma GCC unroll 4
      for (int c = 1; c < C; ++c) sum += rows[c] * f[s][c];
      to -= sum;
    }
  }
}

/// Takes from the C columns from j on what the rows behind them make, and solves with their triangle.
template <int C, int R, bool AHEAD, class T>
SNAPWING_INLINE void backwardBlock(const T* first, std::size_t stride, int j, const double* inverse,
                                   const Parts<R>& part) {
  const T* column = first + j * stride;
  Four sum[R][C];
#pragma GCC unroll 4
  for (int s = 0; s < R; ++s) {
#pragma GCC unroll 4
    for (int c = 0; c < C; ++c) sum[s][c] = Four{};
  }
  for (int i = j + LANES; i < static_cast<int>(stride); i += LANES) {
    if (AHEAD)
      prefetch<C>(column + i, static_cast<std::ptrdiff_t>(stride), -static_cast<std::ptrdiff_t>(WIDE * stride));
    Four rows[C];
#pragma GCC unroll 4
    for (int c = 0; c < C; ++c) read(column + c * stride + i, rows[c]);
#pragma GCC unroll 4
    for (int s = 0; s < R; ++s) {
      const Four own = *reinterpret_cast<const Four*>(part.of[s] + i);
#pragma GCC unroll 4
      for (int c = 0; c < C; ++c) sum[s][c] += rows[c] * own;
    }
  }
#pragma GCC unroll 4
  for (int s = 0; s < R; ++s) {
    double* own = part.of[s];
#pragma GCC unroll 4
    for (int c = C - 1; c >= 0; --c) {
      double value = own[j + c] - ((sum[s][c][0] + sum[s][c][2]) + (sum[s][c][1] + sum[s][c][3]));
      for (int k = c + 1; k < LANES; ++k) {  // rows behind the last column, too
        value -= column[c * stride + j + k] * own[j + k];
      }
      own[j + c] = value * inverse[j + c];
    }
  }
}

template <int R, class T>
SNAPWING_INLINE void forwardIn(const T* first, std::size_t stride, int columns, const double* inverse,
                               const Parts<R>& part) {
  int j = 0;
  for (; j + WIDE <= columns && stride < LONG; j += WIDE) {
    forwardBlock<WIDE, R, false>(first, stride, j, inverse, part);
  }
  for (; j + WIDE <= columns; j += WIDE) forwardBlock<WIDE, R, true>(first, stride, j, inverse, part);
  switch (columns - j) {
    case 3:
      return forwardBlock<3, R, false>(first, stride, j, inverse, part);
    case 2:
      return forwardBlock<2, R, false>(first, stride, j, inverse, part);
    case 1:
      return forwardBlock<1, R, false>(first, stride, j, inverse, part);
    default:
      return;
  }
}

template <int R, class T>
SNAPWING_INLINE void backwardIn(const T* first, std::size_t stride, int columns, const double* inverse,
                                const Parts<R>& part) {
  int j = columns - columns % WIDE;
  switch (columns - j) {
    case 3:
      backwardBlock<3, R, false>(first, stride, j, inverse, part);
      break;
    case 2:
      backwardBlock<2, R, false>(first, stride, j, inverse, part);
      break;
    case 1:
      backwardBlock<1, R, false>(first, stride, j, inverse, part);
      break;
    default:
      break;
  }
  for (j -= WIDE; j >= 0 && stride < LONG; j -= WIDE) {
    backwardBlock<WIDE, R, false>(first, stride, j, inverse, part);
  }
  for (; j >= 0; j -= WIDE) backwardBlock<WIDE, R, true>(first, stride, j, inverse, part);
}

/// One sweep forwards and one back over all panels.
template <int R, class T>
SNAPWING_INLINE void sweepAll(const Sweep& sweep, const T* values, double* x) {
  const std::size_t size = sweep.size;
  Parts<R> part;
  for (int s = 0; s < R; ++s) part.of[s] = sweep.work + s * sweep.room;
  for (const Panel& panel : sweep.panels) {
    const int* rows = sweep.rows + panel.row_at + panel.columns;
    const int columns = panel.columns, below = panel.below();
#pragma GCC unroll 4
    for (int s = 0; s < R; ++s) {
      std::copy_n(x + s * size + panel.first, columns, part.of[s]);
      std::fill(part.of[s] + columns, part.of[s] + panel.stride, 0.0);
    }
    forwardIn<R>(values + panel.at, panel.stride, columns, sweep.inverses + panel.first, part);
#pragma GCC unroll 4
    for (int s = 0; s < R; ++s) {
      double* to = x + s * size;
      std::copy_n(part.of[s], columns, to + panel.first);
      for (int i = 0; i < below; ++i) to[rows[i]] += part.of[s][columns + i];
    }
  }
  for (auto panel = sweep.panels.rbegin(); panel != sweep.panels.rend(); ++panel) {
    const int* rows = sweep.rows + panel->row_at + panel->columns;
    const int columns = panel->columns, below = panel->below();
#pragma GCC unroll 4
    for (int s = 0; s < R; ++s) {
      const double* from = x + s * size;
      std::copy_n(from + panel->first, columns, part.of[s]);
      for (int i = 0; i < below; ++i) part.of[s][columns + i] = from[rows[i]];
      std::fill(part.of[s] + panel->rows, part.of[s] + panel->stride, 0.0);
    }
    backwardIn<R>(values + panel->at, panel->stride, columns, sweep.inverses + panel->first, part);
#pragma GCC unroll 4
    for (int s = 0; s < R; ++s) std::copy_n(part.of[s], columns, x + s * size + panel->first);
  }
}

/// Vectors of eight would be no faster here, and would need sums of eight parts.
#ifdef SNAPWING_BY_PROCESSOR
#define SNAPWING_SWEEP __attribute__((target_clones("avx2", "default")))
#else
#define SNAPWING_SWEEP
#endif
SNAPWING_SWEEP void sweepTogether(const Sweep& sweep, const double* values, int count, double* x) {
  if (count == 1) return sweepAll<1>(sweep, values, x);
  if (count == 2) return sweepAll<2>(sweep, values, x);
  if (count == 3) return sweepAll<3>(sweep, values, x);
  return sweepAll<4>(sweep, values, x);
}
SNAPWING_SWEEP void sweepOnce(const Sweep& sweep, const float* values, double* x) { sweepAll<1>(sweep, values, x); }

}  // namespace

void solve(const Sweep& sweep, const double* values, int count, double* x) { sweepTogether(sweep, values, count, x); }

void solve(const Sweep& sweep, const float* values, double* x) { sweepOnce(sweep, values, x); }

}  // namespace snapwing::solver::supernodal
