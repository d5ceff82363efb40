#include "supernodal.h"

#include <cholmod.h>
#include <sys/mman.h>

#include <algorithm>
#include <cstdint>

#include "snapwing/solver/sparse.h"
#include "supernodal_kernels.h"

namespace snapwing::solver {

using supernodal::LANES;
using supernodal::LARGEST_TILE;
using supernodal::MOST_TOGETHER;
using supernodal::WIDE;

namespace {

/// Factors of so many values do not fit into the nearer caches: a sweep waits for memory, and half of it is read
/// sooner.
constexpr std::size_t BEYOND_CACHES = std::size_t{1} << 20;

constexpr int MOST_COLUMNS = 48;  ///< of a panel: its part of a tile's sums stays in the nearest caches

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

SupernodalFactor::SupernodalFactor(const cholmod_factor_struct& analysis, const SparsePattern& matrix,
                                   const std::vector<int>& place)
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
  for (const Panel& panel : panels_) addUpdates(panel);
  update_begin_.push_back(static_cast<int>(updates_.size()));
  work_.resize(static_cast<std::size_t>(MOST_TOGETHER) * (longest + LANES));
  loads_.resize(matrix.row.size());
  for (std::size_t k = 0; k < place.size(); ++k) loads_[place[k]].source = static_cast<int>(k);
  for (int column = 0; column < size_; ++column) {
    const Panel& panel = panels_[panel_of_[column]];
    if (column == panel.first) begin_.push_back(matrix.start[column]);
    const auto begin = rows_.begin() + static_cast<std::ptrdiff_t>(panel.row_at);
    for (int k = matrix.start[column]; k < matrix.start[column + 1]; ++k) {
      const auto found = std::lower_bound(begin, begin + panel.rows, matrix.row[k]);
      loads_[k].place = static_cast<unsigned>((column - panel.first) * panel.stride + (found - begin));
    }
  }
  begin_.push_back(matrix.start[size_]);
}

/// Panel after panel is cleared, while it is about to be written: one pass over memory.
void SupernodalFactor::load(const std::vector<double>& values) {
  for (std::size_t k = 0; k < panels_.size(); ++k) {
    const Panel& panel = panels_[k];
    double* to = values_.data() + panel.at;
    std::fill_n(to, static_cast<std::size_t>(panel.columns) * panel.stride, 0.0);
#pragma GCC unroll 4
    for (int v = begin_[k]; v < begin_[k + 1]; ++v) to[loads_[v].place] = values[loads_[v].source];
  }
}

bool SupernodalFactor::eliminate(const Panel& panel) {
  return supernodal::eliminate(values_.data() + panel.at, panel.stride, panel.columns, inverse_.data() + panel.first);
}

/// Finds where a panel's rows lie in the later panels, once for all factors: a search at each took a seventh of the
/// time of a planar arm's.
void SupernodalFactor::addUpdates(const Panel& panel) {
  update_begin_.push_back(static_cast<int>(updates_.size()));
  const int below = panel.below();
  const int* rows = rows_.data() + panel.row_at + panel.columns;
  for (int begin = 0, end = 0; begin < below; begin = end) {
    const int number = panel_of_[rows[begin]];
    const Panel& to = panels_[number];
    while (end < below && rows[end] < to.first + to.columns) ++end;
    updates_.push_back({number, begin, end, relative_.size()});
    const int* to_rows = rows_.data() + to.row_at;
    for (int k = begin, i = 0; k < below; ++k) {
      while (to_rows[i] != rows[k]) ++i;
      relative_.push_back(i++);
    }
  }
}

/// Takes what a finished panel's rows below its diagonal block make of later columns from these.
void SupernodalFactor::update(int number) {
  const Panel& panel = panels_[number];
  const int* rows = rows_.data() + panel.row_at + panel.columns;
  const double* lower = values_.data() + panel.at + panel.columns;
  for (int u = update_begin_[number]; u < update_begin_[number + 1]; ++u) {
    const Update& update = updates_[u];
    const Panel& to = panels_[update.panel];
    // The kernel counts rows from the diagonal block's end, the list from the update's first row.
    const int* relative = relative_.data() + update.relative - update.begin;
    supernodal::subtract(lower, panel.stride, panel.columns, update.begin, update.end, panel.below(),
                         {values_.data() + to.at, static_cast<std::size_t>(to.stride), rows, to.first, relative});
  }
}

bool SupernodalFactor::factorize(const std::vector<double>& values) {
  rounded_now_ = false;
  load(values);
  for (int number = 0; number < static_cast<int>(panels_.size()); ++number) {
    const Panel& panel = panels_[number];
    if (!eliminate(panel)) return false;
    update(number);
    if (!rounded_.empty()) round(panel);  // while it is in the caches
  }
  rounded_now_ = !rounded_.empty();
  return true;
}

void SupernodalFactor::round(const Panel& panel) const {
  const auto from = values_.begin() + static_cast<std::ptrdiff_t>(panel.at);
  std::copy_n(from, static_cast<std::size_t>(panel.columns) * panel.stride,
              rounded_.begin() + (from - values_.begin()));
}

supernodal::Sweep SupernodalFactor::sweep() const {
  return {panels_,     inverse_.data(), rows_.data(), static_cast<std::size_t>(size_), work_.size() / MOST_TOGETHER,
          work_.data()};
}

void SupernodalFactor::solve(double* x, int count) const {
  for (int done = 0; done < count; done += MOST_TOGETHER) {
    supernodal::solve(sweep(), values_.data(), std::min(MOST_TOGETHER, count - done),
                      x + static_cast<std::size_t>(done) * size_);
  }
}

void SupernodalFactor::solveNear(double* x) const {
  if (values_.size() < BEYOND_CACHES) return solve(x);
  if (!rounded_now_) {
    rounded_.resize(values_.size());
    for (const Panel& panel : panels_) round(panel);
    rounded_now_ = true;
  }
  supernodal::solve(sweep(), rounded_.data(), x);
}

}  // namespace snapwing::solver
