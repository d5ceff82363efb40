#pragma once
/// What a checked arm is worth beyond its cells: values and curve extrapolated over cell sizes and kernels, with an
/// error bar.

#include <limits>

#include "snapwing/design/arm/arm_check.h"

namespace snapwing::design {

/// Cells that an outline cuts converge with the first power of their size: the shipped arm's peak falls by .110 N from
/// 1 to .5 mm and by .053 N from .5 to .25 mm (docs/design.md). So q = q_fine + (q_fine - q_coarse) / (r - 1) with the
/// ratio r of the sizes. An order between .81 and 1.32 in place of 1 moves the correction by at most a third.
constexpr double DOUBT_OF_CORRECTION = 1.0 / 3;

/// A value in the limit of small cells; the error is a half width, and NaN if there is nothing to estimate it from.
struct ArmEstimate {
  double value = std::numeric_limits<double>::quiet_NaN();
  double error = std::numeric_limits<double>::quiet_NaN();
  double low() const { return value - error; }
  double high() const { return value + error; }
};

/// Limit of small cells of a quantity of the check's planar or solid bodies, without those of a moved outline. Each
/// kernel with at least two cell sizes is extrapolated from its two finest; the value is their mean, the error the
/// larger of half their spread and a third of the largest correction. NaN if no kernel has two sizes, or if the
/// quantity is not finite in one of those used.
ArmEstimate estimate(const ArmCheck& check, bool solid, double (*quantity)(const ArmCheckCase&));

/// The curve in the limit of small cells from the two finest planar bodies of the linear kernel, point by point; a
/// linear combination of curves, so force stays the slope of energy. Pictures are those of the finer body, a point is
/// stable where both are. Empty if there are no two such bodies with the same travels.
vehicle::ForceTable extrapolatedTable(const ArmCheck& check);

}  // namespace snapwing::design
