#include "supernodal.h"

#include <cholmod.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "snapwing/common/wide.h"
#include "snapwing/solver/sparse.h"

namespace snapwing::solver {

namespace {

constexpr int HIGH = 8, WIDE = 4;  ///< rows and columns of a tile
/// The compiler makes of it what the processor has: the sums are the same.
typedef double Rows __attribute__((vector_size(HIGH * sizeof(double)), aligned(sizeof(double)), may_alias));

/// tile(r, c) = sum over k of a(r, k) b(c, k), where the columns of both are `stride` apart.
inline __attribute__((always_inline)) void productByColumns(const double* __restrict a, const double* __restrict b,
                                                            std::size_t stride, int count, double* __restrict tile) {
  double first[HIGH] = {}, second[HIGH] = {}, third[HIGH] = {}, fourth[HIGH] = {};
  for (int k = 0; k < count; ++k, a += stride, b += stride) {
    const double b0 = b[0], b1 = b[1], b2 = b[2], b3 = b[3];
    for (int r = 0; r < HIGH; ++r) {
      first[r] += a[r] * b0, second[r] += a[r] * b1;
      third[r] += a[r] * b2, fourth[r] += a[r] * b3;
    }
  }
  double* to = tile;
  for (const double* column : {first, second, third, fourth}) to = std::copy_n(column, HIGH, to);
}

#ifdef SNAPWING_BY_PROCESSOR
/// Whole vectors of eight, which the compiler would take apart through memory where the processor has none.
__attribute__((target("avx512f"))) void product(const double* __restrict a, const double* __restrict b,
                                                std::size_t stride, int count, double* __restrict tile) {
  Rows sum[WIDE] = {};
  for (int k = 0; k < count; ++k, a += stride, b += stride) {
    const Rows rows = *reinterpret_cast<const Rows*>(a);
    for (int c = 0; c < WIDE; ++c) sum[c] += rows * b[c];
  }
  std::memcpy(tile, sum, sizeof(sum));
}
__attribute__((target("avx2"))) void product(const double* __restrict a, const double* __restrict b, std::size_t stride,
                                             int count, double* __restrict tile) {
  productByColumns(a, b, stride, count, tile);
}
__attribute__((target("default")))
#endif
void product(const double* __restrict a, const double* __restrict b, std::size_t stride, int count,
             double* __restrict tile) {
  productByColumns(a, b, stride, count, tile);
}

/// to -= from f, entry by entry.
SNAPWING_WIDE void subtract(const double* __restrict from, double f, int count, double* __restrict to) {
  for (int i = 0; i < count; ++i) to[i] -= from[i] * f;
}

SNAPWING_WIDE void scale(double f, int count, double* values) {
  for (int i = 0; i < count; ++i) values[i] *= f;
}

/// Sums of the rows of four columns, each with its factor.
SNAPWING_WIDE void addFour(const double* __restrict column, std::size_t stride, const double* __restrict f, int count,
                           double* __restrict sum) {
  const double *a = column, *b = a + stride, *c = b + stride, *d = c + stride;
  for (int i = 0; i < count; ++i) sum[i] += (a[i] * f[0] + b[i] * f[1]) + (c[i] * f[2] + d[i] * f[3]);
}

/// Scalar products of four columns with x, in eight partial sums each.
SNAPWING_WIDE void dotFour(const double* __restrict column, std::size_t stride, const double* __restrict x, int count,
                           double* __restrict result) {
  Rows sum[WIDE] = {};
  int i = 0;
  for (; i + HIGH <= count; i += HIGH) {
    const Rows rows = *reinterpret_cast<const Rows*>(x + i);
    for (int c = 0; c < WIDE; ++c) sum[c] += *reinterpret_cast<const Rows*>(column + c * stride + i) * rows;
  }
  for (int c = 0; c < WIDE; ++c) {
    double rest = 0;
    for (int k = i; k < count; ++k) rest += column[c * stride + k] * x[k];
    const Rows& s = sum[c];
    result[c] = (((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7]))) + rest;
  }
}

}  // namespace

SupernodalFactor::SupernodalFactor(const cholmod_factor_struct& analysis, const SparsePattern& matrix)
    : size_(matrix.size) {
  const auto* super = static_cast<const int*>(analysis.super);
  const auto* row_begin = static_cast<const int*>(analysis.pi);
  const auto* value_begin = static_cast<const int*>(analysis.px);
  const auto* row = static_cast<const int*>(analysis.s);
  rows_.assign(row, row + analysis.ssize);
  panel_of_.resize(size_);
  int most_rows = 0;
  for (std::size_t k = 0; k < analysis.nsuper; ++k) {
    Panel panel;
    panel.first = super[k], panel.columns = super[k + 1] - super[k];
    panel.rows = row_begin[k + 1] - row_begin[k];
    panel.at = value_begin[k], panel.row_at = row_begin[k];
    most_rows = std::max(most_rows, panel.rows);
    std::fill_n(panel_of_.begin() + panel.first, panel.columns, static_cast<int>(k));
    panels_.push_back(panel);
  }
  // A tile may reach beyond the last row of the last column.
  values_.assign(analysis.xsize + HIGH, 0.0);
  inverse_.resize(size_);
  relative_.resize(most_rows);
  work_.resize(most_rows);
  place_.reserve(matrix.row.size());
  for (int column = 0; column < size_; ++column) {
    const Panel& panel = panels_[panel_of_[column]];
    const auto begin = rows_.begin() + static_cast<std::ptrdiff_t>(panel.row_at);
    for (int k = matrix.start[column]; k < matrix.start[column + 1]; ++k) {
      const auto found = std::lower_bound(begin, begin + panel.rows, matrix.row[k]);
      place_.push_back(panel.at + static_cast<std::size_t>(column - panel.first) * panel.rows + (found - begin));
    }
  }
}

/// Columns of one panel, four at a time: what those before take from them, then themselves.
bool SupernodalFactor::eliminate(const Panel& panel) {
  double* const first = values_.data() + panel.at;
  const auto stride = static_cast<std::size_t>(panel.rows);
  double tile[WIDE * HIGH];
  for (int j0 = 0; j0 < panel.columns; j0 += WIDE) {
    const int wide = std::min(WIDE, panel.columns - j0);
    for (int i = j0; j0 > 0 && i < panel.rows; i += HIGH) {
      product(first + i, first + j0, stride, j0, tile);
      const int high = std::min(HIGH, panel.rows - i);
      for (int c = 0; c < wide; ++c) {
        double* to = first + (j0 + c) * stride + i;
        for (int r = 0; r < high; ++r) to[r] -= tile[c * HIGH + r];
      }
    }
    for (int j = j0; j < j0 + wide; ++j) {
      double* column = first + j * stride;
      for (int k = j0; k < j; ++k) {
        subtract(first + k * stride + j, first[k * stride + j], panel.rows - j, column + j);
      }
      if (!(column[j] > 0)) return false;
      column[j] = std::sqrt(column[j]);
      inverse_[panel.first + j] = 1 / column[j];
      scale(inverse_[panel.first + j], panel.rows - j - 1, column + j + 1);
    }
  }
  return true;
}

/// Takes what a finished panel's rows below its diagonal block make of later columns from these.
void SupernodalFactor::update(const Panel& panel) {
  const int below = panel.below();
  const int* rows = rows_.data() + panel.row_at + panel.columns;
  const double* lower = values_.data() + panel.at + panel.columns;
  const auto stride = static_cast<std::size_t>(panel.rows);
  double tile[WIDE * HIGH];
  for (int begin = 0, end = 0; begin < below; begin = end) {
    const int target = panel_of_[rows[begin]];
    const Panel& to = panels_[target];
    while (end < below && panel_of_[rows[end]] == target) ++end;
    const int* to_rows = rows_.data() + to.row_at;
    for (int k = begin, i = 0; k < below; ++k) {
      while (to_rows[i] != rows[k]) ++i;
      relative_[k] = i;
    }
    for (int j = begin; j < end; j += WIDE) {
      const int wide = std::min(WIDE, end - j);
      for (int i = j; i < below; i += HIGH) {
        product(lower + i, lower + j, stride, panel.columns, tile);
        const int high = std::min(HIGH, below - i);
        for (int c = 0; c < wide; ++c) {
          double* column = values_.data() + to.at + static_cast<std::size_t>(rows[j + c] - to.first) * to.rows;
          for (int r = std::max(0, j + c - i); r < high; ++r) column[relative_[i + r]] -= tile[c * HIGH + r];
        }
      }
    }
  }
}

bool SupernodalFactor::factorize(const std::vector<double>& values) {
  std::fill(values_.begin(), values_.end(), 0.0);
  for (std::size_t k = 0; k < values.size(); ++k) values_[place_[k]] = values[k];
  for (const Panel& panel : panels_) {
    if (!eliminate(panel)) return false;
    update(panel);
  }
  return true;
}

void SupernodalFactor::solve(double* x) const {
  double* const sum = work_.data();
  for (const Panel& panel : panels_) {
    const double* first = values_.data() + panel.at;
    const auto stride = static_cast<std::size_t>(panel.rows);
    const int *rows = rows_.data() + panel.row_at + panel.columns, below = panel.below();
    double* own = x + panel.first;
    std::fill(sum, sum + below, 0.0);
    int j = 0;
    for (; j + WIDE <= panel.columns; j += WIDE) {
      const double* column = first + j * stride;
      double f[WIDE];
      for (int c = 0; c < WIDE; ++c) {
        double value = own[j + c];
        for (int k = 0; k < c; ++k) value -= column[k * stride + j + c] * f[k];
        own[j + c] = f[c] = value * inverse_[panel.first + j + c];
      }
      const double minus[WIDE] = {-f[0], -f[1], -f[2], -f[3]};
      addFour(column + j + WIDE, stride, minus, panel.columns - j - WIDE, own + j + WIDE);
      addFour(column + panel.columns, stride, f, below, sum);
    }
    for (; j < panel.columns; ++j) {
      const double* column = first + j * stride;
      own[j] *= inverse_[panel.first + j];
      subtract(column + j + 1, own[j], panel.columns - j - 1, own + j + 1);
      subtract(column + panel.columns, -own[j], below, sum);
    }
    for (int i = 0; i < below; ++i) x[rows[i]] -= sum[i];
  }
  for (auto panel = panels_.rbegin(); panel != panels_.rend(); ++panel) {
    const double* first = values_.data() + panel->at;
    const auto stride = static_cast<std::size_t>(panel->rows);
    const int *rows = rows_.data() + panel->row_at + panel->columns, below = panel->below();
    double* own = x + panel->first;
    for (int i = 0; i < below; ++i) sum[i] = x[rows[i]];
    int j = panel->columns;
    for (; j % WIDE != 0; --j) {
      const double* column = first + (j - 1) * stride;
      double value = own[j - 1];
      for (int i = j; i < panel->columns; ++i) value -= column[i] * own[i];
      for (int i = 0; i < below; ++i) value -= column[panel->columns + i] * sum[i];
      own[j - 1] = value * inverse_[panel->first + j - 1];
    }
    for (; j > 0; j -= WIDE) {
      const double* column = first + (j - WIDE) * stride;
      double of_block[WIDE], of_rest[WIDE];
      dotFour(column + j, stride, own + j, panel->columns - j, of_block);
      dotFour(column + panel->columns, stride, sum, below, of_rest);
      for (int c = WIDE - 1; c >= 0; --c) {
        const int here = j - WIDE + c;
        double value = own[here] - (of_block[c] + of_rest[c]);
        for (int k = c + 1; k < WIDE; ++k) value -= column[c * stride + j - WIDE + k] * own[j - WIDE + k];
        own[here] = value * inverse_[panel->first + here];
      }
    }
  }
}

}  // namespace snapwing::solver
