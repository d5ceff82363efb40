#pragma once
/// A number with its error bar, in the limit of small cells.

#include <limits>
#include <vector>

namespace snapwing::validation {

/// Half width `error` about `value`, in one unit. NaN: there is no number.
struct Estimate {
  double value = std::numeric_limits<double>::quiet_NaN();
  double error = 0;
  /// The same in another unit. @param factor  > 0
  Estimate times(double factor) const { return {factor * value, factor * error}; }
  Estimate less(double other) const { return {value - other, error}; }
};

/// Limit of a number that moves with the first power of the cells' size, as cells that an outline cuts do: Richardson's
/// q = q_fine + (q_fine - q_coarse) / (ratio - 1). The error is a third of that correction, which covers orders from
/// .81 to 1.32 (docs/design.md). @param ratio  of the sizes, coarse to fine, > 1
Estimate limitOfCells(double fine, double coarse, double ratio);

/// Mean of the limits of several kernels. The error is half their spread, or their largest error if that is more.
Estimate meanOf(const std::vector<Estimate>& limits);

}  // namespace snapwing::validation
