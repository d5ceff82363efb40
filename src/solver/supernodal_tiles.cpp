#include <algorithm>
#include <cmath>

#include "supernodal_kernels.h"

namespace snapwing::solver::supernodal {

namespace {

/// A tile's rows: `COUNT` vectors of `N`.
template <int N, int COUNT>
struct Tile {
  using Vector = typename Lanes<N>::type;
  static constexpr int COUNT_OF = COUNT, ROWS = N * COUNT;
  static SNAPWING_INLINE Vector& at(double* p) { return *reinterpret_cast<Vector*>(p); }
  static SNAPWING_INLINE const Vector& at(const double* p) { return *reinterpret_cast<const Vector*>(p); }
};

/// What a processor works in: tiles of the most rows, of half and of the least.
struct ByEight {
  using Large = Tile<8, 2>;
  using Middle = Tile<8, 1>;
  using Small = Tile<4, 1>;
};
struct ByFour {
  using Large = Tile<4, 2>;
  using Middle = Tile<4, 2>;
  using Small = Tile<4, 1>;
};
struct ByTwo {
  using Large = Tile<2, 2>;
  using Middle = Tile<2, 2>;
  using Small = Tile<2, 2>;
};

/// sum[c][n] = sum over k of a(rows of vector n, k) b(c, k), where the columns of both are `stride` apart.
template <class T, int C>
SNAPWING_INLINE void product(const double* __restrict a, const double* __restrict b, std::size_t stride, int count,
                             typename T::Vector (&sum)[C][T::COUNT_OF]) {
  using Vector = typename T::Vector;
  constexpr int N = T::COUNT_OF, STEP = T::ROWS / N;
#pragma GCC unroll 4
  for (int c = 0; c < C; ++c) {
#pragma GCC unroll 4
    for (int n = 0; n < N; ++n) sum[c][n] = Vector{};
  }
#pragma GCC unroll 2
  for (int k = 0; k < count; ++k) {
    Vector rows[N];
#pragma GCC unroll 4
    for (int n = 0; n < N; ++n) rows[n] = T::at(a + n * STEP);
#pragma GCC unroll 4
    for (int c = 0; c < C; ++c) {
      const double factor = b[c];
#pragma GCC unroll 4
      for (int n = 0; n < N; ++n) sum[c][n] += rows[n] * factor;
    }
    a += stride, b += stride;
  }
}

/// Cholesky factor of a block of C columns. @param block  columns four apart, lower part
/// @return false if a pivot is not positive
template <int C>
SNAPWING_INLINE bool factorBlock(double* block, double* inverse) {
#pragma GCC unroll 4
  for (int c = 0; c < C; ++c) {
    double* column = block + c * LANES;
    for (int k = 0; k < c; ++k) {
      for (int r = c; r < C; ++r) column[r] -= block[k * LANES + r] * block[k * LANES + c];
    }
    if (!(column[c] > 0)) return false;
    column[c] = std::sqrt(column[c]);
    inverse[c] = 1 / column[c];
    for (int r = c + 1; r < C; ++r) column[r] *= inverse[c];
  }
  return true;
}

/// A tile of rows of C columns from j0 on: what the columns before take from it, then the block's own triangle.
template <class T, int C>
SNAPWING_INLINE void finishRows(double* first, std::size_t stride, int i, int j0, const double* block,
                                const double* inverse) {
  constexpr int N = T::COUNT_OF, STEP = T::ROWS / N;
  typename T::Vector sum[C][N];
  product<T, C>(first + i, first + j0, stride, j0, sum);
#pragma GCC unroll 4
  for (int n = 0; n < N; ++n) {
    double* to = first + j0 * stride + i + n * STEP;
#pragma GCC unroll 4
    for (int c = 0; c < C; ++c) {
      sum[c][n] = T::at(to + c * stride) - sum[c][n];
#pragma GCC unroll 4
      for (int k = 0; k < c; ++k) sum[c][n] -= sum[k][n] * block[k * LANES + c];
      sum[c][n] *= inverse[c];
      T::at(to + c * stride) = sum[c][n];
    }
  }
}

template <class P, int C>
SNAPWING_INLINE bool eliminateBlock(double* first, std::size_t stride, int j0, double* inverse) {
  using T = typename P::Small;
  constexpr int N = T::COUNT_OF, STEP = T::ROWS / N;
  double block[C * LANES];
  typename T::Vector sum[C][N];
  product<T, C>(first + j0, first + j0, stride, j0, sum);
  for (int c = 0; c < C; ++c) {
    for (int n = 0; n < N; ++n) {
      T::at(block + c * LANES + n * STEP) = T::at(first + (j0 + c) * stride + j0 + n * STEP) - sum[c][n];
    }
  }
  if (!factorBlock<C>(block, inverse)) return false;
  const int end = static_cast<int>(stride);
  int i = j0;
  if (C == WIDE) {
    for (int c = 0; c < C; ++c) {
      for (int r = c; r < C; ++r) first[(j0 + c) * stride + j0 + r] = block[c * LANES + r];
    }
    i += WIDE;
  }
  for (; end - i >= P::Large::ROWS; i += P::Large::ROWS) {
    finishRows<typename P::Large, C>(first, stride, i, j0, block, inverse);
  }
  for (; end - i >= P::Middle::ROWS; i += P::Middle::ROWS) {
    finishRows<typename P::Middle, C>(first, stride, i, j0, block, inverse);
  }
  for (; i < end; i += T::ROWS) finishRows<T, C>(first, stride, i, j0, block, inverse);
  for (int c = 0; c < C && C != WIDE; ++c) {
    for (int r = c; r < C; ++r) first[(j0 + c) * stride + j0 + r] = block[c * LANES + r];
  }
  return true;
}

/// Columns of one panel, four at a time.
template <class P>
SNAPWING_INLINE bool eliminateIn(double* first, std::size_t stride, int columns, double* inverse) {
  int j = 0;
  for (; j + WIDE <= columns; j += WIDE) {
    if (!eliminateBlock<P, WIDE>(first, stride, j, inverse + j)) return false;
  }
  switch (columns - j) {
    case 3:
      return eliminateBlock<P, 3>(first, stride, j, inverse + j);
    case 2:
      return eliminateBlock<P, 2>(first, stride, j, inverse + j);
    case 1:
      return eliminateBlock<P, 1>(first, stride, j, inverse + j);
    default:
      return true;
  }
}

/// Subtracts the product of rows from i on with rows j .. j + C. Above the diagonal nothing reads what comes there.
template <class T, int C>
SNAPWING_INLINE void subtractTile(const double* lower, std::size_t stride, int columns, int i, int j, int high,
                                  const Target& to) {
  constexpr int N = T::COUNT_OF, STEP = T::ROWS / N;
  typename T::Vector sum[C][N];
  product<T, C>(lower + i, lower + j, stride, columns, sum);
  const int* relative = to.relative + i;
  if (high >= T::ROWS && relative[T::ROWS - 1] - relative[0] == T::ROWS - 1) {
#pragma GCC unroll 4
    for (int c = 0; c < C; ++c) {
      double* column = to.values + static_cast<std::size_t>(to.column[j + c] - to.first) * to.stride + relative[0];
#pragma GCC unroll 4
      for (int n = 0; n < N; ++n) T::at(column + n * STEP) -= sum[c][n];
    }
    return;
  }
  const int count = std::min(high, T::ROWS);
  double tile[C * T::ROWS];
#pragma GCC unroll 4
  for (int c = 0; c < C; ++c) {
#pragma GCC unroll 4
    for (int n = 0; n < N; ++n) T::at(tile + c * T::ROWS + n * STEP) = sum[c][n];
  }
  for (int c = 0; c < C; ++c) {
    double* column = to.values + static_cast<std::size_t>(to.column[j + c] - to.first) * to.stride;
    for (int r = 0; r < count; ++r) column[relative[r]] -= tile[c * T::ROWS + r];
  }
}

template <class P, int C>
SNAPWING_INLINE void subtractColumns(const double* lower, std::size_t stride, int columns, int j, int below,
                                     const Target& to) {
  using Large = typename P::Large;
  using Middle = typename P::Middle;
  using Small = typename P::Small;
  int i = j;
  for (; below - i > Middle::ROWS; i += Large::ROWS) {
    if (below - i < Large::ROWS) break;
    subtractTile<Large, C>(lower, stride, columns, i, j, below - i, to);
  }
  for (; below - i > Small::ROWS; i += Middle::ROWS) {
    subtractTile<Middle, C>(lower, stride, columns, i, j, below - i, to);
  }
  for (; i < below; i += Small::ROWS) subtractTile<Small, C>(lower, stride, columns, i, j, below - i, to);
}

template <class P>
SNAPWING_INLINE void subtractIn(const double* lower, std::size_t stride, int columns, int begin, int end, int below,
                                const Target& to) {
  int j = begin;
  for (; j + WIDE <= end; j += WIDE) subtractColumns<P, WIDE>(lower, stride, columns, j, below, to);
  switch (end - j) {
    case 3:
      return subtractColumns<P, 3>(lower, stride, columns, j, below, to);
    case 2:
      return subtractColumns<P, 2>(lower, stride, columns, j, below, to);
    case 1:
      return subtractColumns<P, 1>(lower, stride, columns, j, below, to);
    default:
      return;
  }
}

// The same source for each width of vectors: a processor's tiles differ, the order of each sum does not.
// NOLINTBEGIN(bugprone-macro-parentheses): an attribute cannot stand in parentheses
#define SNAPWING_VARIANT(TARGET, WIDTH)                                                                          \
  TARGET bool eliminatePanel(double* first, std::size_t stride, int columns, double* inverse) {                  \
    return eliminateIn<WIDTH>(first, stride, columns, inverse);                                                  \
  }                                                                                                              \
  TARGET void subtractPanel(const double* lower, std::size_t stride, int columns, int begin, int end, int below, \
                            const Target& to) {                                                                  \
    subtractIn<WIDTH>(lower, stride, columns, begin, end, below, to);                                            \
  }
// NOLINTEND(bugprone-macro-parentheses)

#ifdef SNAPWING_BY_PROCESSOR
SNAPWING_VARIANT(__attribute__((target("avx512f"))), ByEight)
SNAPWING_VARIANT(__attribute__((target("avx2"))), ByFour)
SNAPWING_VARIANT(__attribute__((target("default"))), ByTwo)
#else
SNAPWING_VARIANT(, ByTwo)
#endif

}  // namespace

bool eliminate(double* first, std::size_t stride, int columns, double* inverse) {
  return eliminatePanel(first, stride, columns, inverse);
}

void subtract(const double* lower, std::size_t stride, int columns, int begin, int end, int below, const Target& to) {
  subtractPanel(lower, stride, columns, begin, end, below, to);
}

}  // namespace snapwing::solver::supernodal
