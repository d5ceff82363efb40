#pragma once
/// Independent check of an arm design: thresholded, smoothed, meshed anew, traced 0 -> end -> 0 with stability. The
/// verdict comes from here, not from the optimiser.

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "snapwing/common/force_table.h"
#include "snapwing/design/arm_settings.h"
#include "snapwing/design/arm_shape.h"

namespace snapwing::design {

/// One traced body. Forces are TOTALS of the vehicle's arms, as the targets are.
struct ArmCheckCase {
  std::string name;      ///< "grey", "1.00 mm", "0.50 mm, +0.20 mm", "1.25 mm solid", ...
  std::string rung;      ///< model and kernel in words
  double cell_size = 0;  ///< [m]
  double offset = 0;     ///< [m] of the outline
  bool traced = false;   ///< forward and back reached their ends
  std::string message;
  common::CurveFeatures features{};
  double hysteresis_share = 0;  ///< max |forward - back| over the peak [1]
  bool turns = true;            ///< false: a scene without a monitor of a rotation
  double rotation_second = std::numeric_limits<double>::quiet_NaN();  ///< [rad] at the second equilibrium; NaN if none
  double rotation_end = std::numeric_limits<double>::quiet_NaN();     ///< [rad] at the largest travel
  int unstable_points = 0;
  bool bistable = false;
  common::ForceTable table;
};

/// One wish of the vehicle and whether every case meets it.
struct ArmTarget {
  std::string name, wanted;
  double low = 0, high = 0;  ///< range over the cases without offset
  bool met = false;
};

struct ArmCheck {
  std::vector<ArmCheckCase> cases;
  std::vector<ArmTarget> targets;
  bool bistable = false;  ///< on every re-meshed case, offset ones too
  bool all_met = false;
  bool complete = false;  ///< false: cancelled
  /// The finest planar case of the linear kernel without offset that could be traced; null if none.
  const ArmCheckCase* reference() const;
};

/// @param shape     of the thresholded design
/// @param grey      the optimiser's own field, traced for comparison; empty: not
/// @param progress  told each case that begins, and "" at every point of a path; true cancels. Cases run side by side
///                  on the settings' threads, but only one at a time asks
ArmCheck checkArm(const ArmDesignSettings& settings, const ArmShape& shape, const mpm::DensityField& grey,
                  const std::function<bool(const std::string&)>& progress);

}  // namespace snapwing::design
