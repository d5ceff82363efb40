#include "supernodal.h"

#include <cholmod.h>
#include <sys/mman.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "snapwing/common/wide.h"
#include "snapwing/solver/sparse.h"

namespace snapwing::solver {

namespace {

using Panel = SupernodalFactor::Panel;

constexpr int WIDE = 4;            ///< columns of a tile
constexpr int LANES = 4;           ///< rows of the least tile: strides are multiples of it
constexpr int MOST_COLUMNS = 48;   ///< of a panel: its part of a tile's sums stays in the nearest caches
constexpr int MOST_TOGETHER = 4;   ///< right sides in one sweep
constexpr std::size_t LONG = 128;  ///< rows of a panel whose columns are prefetched
constexpr int LARGEST_TILE = 16;   ///< rows

#define SNAPWING_INLINE inline __attribute__((always_inline))

/// N doubles side by side, anywhere in memory.
template <int N>
struct Lanes {
  typedef double type __attribute__((vector_size(N * sizeof(double)), aligned(sizeof(double)), may_alias));
};
typedef Lanes<4>::type Four;

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

/// Where a finished panel's rows are subtracted.
struct Target {
  double* values;
  std::size_t stride;
  const int* column;    ///< of the matrix, of each row that is one of the target's
  int first;            ///< column of the target
  const int* relative;  ///< place in the target of each row
};

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

/// A sweep's room for each right side: the panel's part of it.
template <int R>
struct Parts {
  double* of[R];
};

/// Asks for what the next block of columns needs at the same rows. The processor's own guess fails at each column's
/// end.
template <int C>
SNAPWING_INLINE void prefetch(const double* column, std::ptrdiff_t stride, std::ptrdiff_t block) {
#pragma GCC unroll 4
  for (int c = 0; c < C; ++c) __builtin_prefetch(column + c * stride + block);
}

/// Solves with the C columns from j on and takes their share from the rows behind them.
/// @tparam AHEAD  columns are so long that it pays to prefetch the next block's
template <int C, int R, bool AHEAD>
SNAPWING_INLINE void forwardBlock(const double* first, std::size_t stride, int j, const double* inverse,
                                  const Parts<R>& part) {
  const double* column = first + j * stride;
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
    for (int c = 0; c < C; ++c) rows[c] = *reinterpret_cast<const Four*>(column + c * stride + i);
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
template <int C, int R, bool AHEAD>
SNAPWING_INLINE void backwardBlock(const double* first, std::size_t stride, int j, const double* inverse,
                                   const Parts<R>& part) {
  const double* column = first + j * stride;
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
    for (int c = 0; c < C; ++c) rows[c] = *reinterpret_cast<const Four*>(column + c * stride + i);
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

template <int R>
SNAPWING_INLINE void forwardIn(const double* first, std::size_t stride, int columns, const double* inverse,
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

template <int R>
SNAPWING_INLINE void backwardIn(const double* first, std::size_t stride, int columns, const double* inverse,
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
template <int R>
SNAPWING_INLINE void sweep(const std::vector<Panel>& panels, const double* values, const double* inverses,
                           const int* all_rows, std::size_t size, const Parts<R>& part, double* x) {
  for (const Panel& panel : panels) {
    const int* rows = all_rows + panel.row_at + panel.columns;
    const int columns = panel.columns, below = panel.below();
#pragma GCC unroll 4
    for (int s = 0; s < R; ++s) {
      std::copy_n(x + s * size + panel.first, columns, part.of[s]);
      std::fill(part.of[s] + columns, part.of[s] + panel.stride, 0.0);
    }
    forwardIn<R>(values + panel.at, panel.stride, columns, inverses + panel.first, part);
#pragma GCC unroll 4
    for (int s = 0; s < R; ++s) {
      double* to = x + s * size;
      std::copy_n(part.of[s], columns, to + panel.first);
      for (int i = 0; i < below; ++i) to[rows[i]] += part.of[s][columns + i];
    }
  }
  for (auto panel = panels.rbegin(); panel != panels.rend(); ++panel) {
    const int* rows = all_rows + panel->row_at + panel->columns;
    const int columns = panel->columns, below = panel->below();
#pragma GCC unroll 4
    for (int s = 0; s < R; ++s) {
      const double* from = x + s * size;
      std::copy_n(from + panel->first, columns, part.of[s]);
      for (int i = 0; i < below; ++i) part.of[s][columns + i] = from[rows[i]];
      std::fill(part.of[s] + panel->rows, part.of[s] + panel->stride, 0.0);
    }
    backwardIn<R>(values + panel->at, panel->stride, columns, inverses + panel->first, part);
#pragma GCC unroll 4
    for (int s = 0; s < R; ++s) std::copy_n(part.of[s], columns, x + s * size + panel->first);
  }
}

template <int R>
SNAPWING_INLINE void sweepIn(const std::vector<Panel>& panels, const double* values, const double* inverses,
                             const int* rows, std::size_t size, std::size_t room, double* work, double* x) {
  Parts<R> part;
  for (int s = 0; s < R; ++s) part.of[s] = work + s * room;
  sweep<R>(panels, values, inverses, rows, size, part, x);
}

/// Zeros, in large pages where the system has them and the factor is of several: a sweep goes through all of memory.
void fillWithZeros(std::size_t count, std::vector<double>& values) {
  values.reserve(count);
#ifdef MADV_HUGEPAGE
  constexpr std::uintptr_t LARGE = 2u << 20;
  const auto begin = (reinterpret_cast<std::uintptr_t>(values.data()) + LARGE - 1) / LARGE * LARGE;
  const auto end = reinterpret_cast<std::uintptr_t>(values.data() + count) / LARGE * LARGE;
  if (end > begin + LARGE) (void)madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
#endif
  values.assign(count, 0.0);
}

// The same source for each width of vectors: a processor's tiles differ, the order of each sum does not.
#define SNAPWING_VARIANT(TARGET, WIDTH)                                                                                \
  TARGET bool eliminatePanel(double* first, std::size_t stride, int columns, double* inverse) {                        \
    return eliminateIn<WIDTH>(first, stride, columns, inverse);                                                        \
  }                                                                                                                    \
  TARGET void subtractPanel(const double* lower, std::size_t stride, int columns, int begin, int end, int below,       \
                            const Target& to) {                                                                        \
    subtractIn<WIDTH>(lower, stride, columns, begin, end, below, to);                                                  \
  }                                                                                                                    \
  TARGET void sweepTogether(const std::vector<Panel>& panels, const double* values, const double* inverses,            \
                            const int* rows, std::size_t size, std::size_t room, double* work, int count, double* x) { \
    if (count == 1) return sweepIn<1>(panels, values, inverses, rows, size, room, work, x);                            \
    if (count == 2) return sweepIn<2>(panels, values, inverses, rows, size, room, work, x);                            \
    if (count == 3) return sweepIn<3>(panels, values, inverses, rows, size, room, work, x);                            \
    return sweepIn<4>(panels, values, inverses, rows, size, room, work, x);                                            \
  }

#ifdef SNAPWING_BY_PROCESSOR
SNAPWING_VARIANT(__attribute__((target("avx512f"))), ByEight)
SNAPWING_VARIANT(__attribute__((target("avx2"))), ByFour)
SNAPWING_VARIANT(__attribute__((target("default"))), ByTwo)
#else
SNAPWING_VARIANT(, ByTwo)
#endif

}  // namespace

/// Panels of one supernode: all have its rows from their own first column on.
void SupernodalFactor::addPanels(int first, int end, const int* rows, int count) {
  const std::size_t row_at = rows_.size();
  rows_.insert(rows_.end(), rows, rows + count);
  const int parts = (end - first + MOST_COLUMNS - 1) / MOST_COLUMNS;
  int wide = (end - first + parts - 1) / parts;
  wide = (wide + WIDE - 1) / WIDE * WIDE;
  for (int column = first; column < end; column += wide) {
    Panel panel;
    panel.first = column, panel.columns = std::min(wide, end - column);
    panel.rows = count - (column - first);
    panel.stride = (panel.rows + LANES - 1) / LANES * LANES;
    panel.at = panels_.empty()
                   ? 0
                   : panels_.back().at + static_cast<std::size_t>(panels_.back().columns) * panels_.back().stride;
    panel.row_at = row_at + (column - first);
    std::fill_n(panel_of_.begin() + column, panel.columns, static_cast<int>(panels_.size()));
    panels_.push_back(panel);
  }
}

SupernodalFactor::SupernodalFactor(const cholmod_factor_struct& analysis, const SparsePattern& matrix)
    : size_(matrix.size) {
  const auto* super = static_cast<const int*>(analysis.super);
  const auto* row_begin = static_cast<const int*>(analysis.pi);
  const auto* row = static_cast<const int*>(analysis.s);
  panel_of_.resize(size_);
  for (std::size_t k = 0; k < analysis.nsuper; ++k) {
    addPanels(super[k], super[k + 1], row + row_begin[k], row_begin[k + 1] - row_begin[k]);
  }
  int longest = 0;
  for (const Panel& panel : panels_) longest = std::max(longest, panel.stride);
  // A tile may reach beyond the last row of the last column.
  const Panel& last = panels_.back();
  fillWithZeros(last.at + static_cast<std::size_t>(last.columns) * last.stride + LARGEST_TILE, values_);
  inverse_.resize(size_);
  relative_.resize(longest);
  work_.resize(static_cast<std::size_t>(MOST_TOGETHER) * (longest + LANES));
  place_.reserve(matrix.row.size());
  for (int column = 0; column < size_; ++column) {
    const Panel& panel = panels_[panel_of_[column]];
    if (column == panel.first) begin_.push_back(matrix.start[column]);
    const auto begin = rows_.begin() + static_cast<std::ptrdiff_t>(panel.row_at);
    for (int k = matrix.start[column]; k < matrix.start[column + 1]; ++k) {
      const auto found = std::lower_bound(begin, begin + panel.rows, matrix.row[k]);
      place_.push_back(panel.at + static_cast<std::size_t>(column - panel.first) * panel.stride + (found - begin));
    }
  }
  begin_.push_back(matrix.start[size_]);
}

/// Column after column is cleared, while it is about to be written: one pass over memory.
void SupernodalFactor::load(const std::vector<double>& values) {
  for (std::size_t k = 0; k < panels_.size(); ++k) {
    const Panel& panel = panels_[k];
    for (int c = 0; c < panel.columns; ++c) {
      std::fill_n(values_.begin() + static_cast<std::ptrdiff_t>(panel.at + static_cast<std::size_t>(c) * panel.stride),
                  panel.stride, 0.0);
    }
    for (int v = begin_[k]; v < begin_[k + 1]; ++v) values_[place_[v]] = values[v];
  }
}

bool SupernodalFactor::eliminate(const Panel& panel) {
  return eliminatePanel(values_.data() + panel.at, panel.stride, panel.columns, inverse_.data() + panel.first);
}

/// Takes what a finished panel's rows below its diagonal block make of later columns from these.
void SupernodalFactor::update(const Panel& panel) {
  const int below = panel.below();
  const int* rows = rows_.data() + panel.row_at + panel.columns;
  const double* lower = values_.data() + panel.at + panel.columns;
  for (int begin = 0, end = 0; begin < below; begin = end) {
    const Panel& to = panels_[panel_of_[rows[begin]]];
    const int beyond = to.first + to.columns;
    while (end < below && rows[end] < beyond) ++end;
    const int* to_rows = rows_.data() + to.row_at;
    for (int k = begin, i = 0; k < below; ++k) {
      while (to_rows[i] != rows[k]) ++i;
      relative_[k] = i++;
    }
    subtractPanel(lower, panel.stride, panel.columns, begin, end, below,
                  {values_.data() + to.at, static_cast<std::size_t>(to.stride), rows, to.first, relative_.data()});
  }
}

bool SupernodalFactor::factorize(const std::vector<double>& values) {
  load(values);
  for (const Panel& panel : panels_) {
    if (!eliminate(panel)) return false;
    update(panel);
  }
  return true;
}

void SupernodalFactor::solve(double* x, int count) const {
  const std::size_t room = work_.size() / MOST_TOGETHER;
  for (int done = 0; done < count; done += MOST_TOGETHER) {
    sweepTogether(panels_, values_.data(), inverse_.data(), rows_.data(), size_, room, work_.data(),
                  std::min(MOST_TOGETHER, count - done), x + static_cast<std::size_t>(done) * size_);
  }
}

}  // namespace snapwing::solver
