#pragma once
/// Independent check of an arm design: thresholded, smoothed, meshed again, traced 0 -> end -> 0 with stability. The
/// verdict comes from here, not from the optimiser.

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "snapwing/design/arm/arm_settings.h"
#include "snapwing/design/arm/arm_shape.h"
#include "snapwing/mpm/density_field.h"
#include "snapwing/vehicle/force_table.h"

namespace snapwing::design {

/// What ArmCheckCase::rung says.
constexpr char PLANAR_LINEAR[] = "planar, linear kernel";
constexpr char PLANAR_QUADRATIC[] = "planar, quadratic B-spline";
constexpr char VOLUMETRIC[] = "volumetric, linear kernel, reduced volume term";

/// One traced body. Forces are TOTALS of the vehicle's arms, as the targets are.
struct ArmCheckCase {
  std::string name;      ///< "grey", "1.00 mm", "0.50 mm, +0.20 mm", "1.25 mm solid", ...
  std::string rung;      ///< model and kernel in words
  double cell_size = 0;  ///< [m]
  double offset = 0;     ///< [m] of the outline
  bool solid = false;    ///< volumetric
  bool traced = false;   ///< forward and back reached their ends
  std::string message;
  vehicle::CurveFeatures features{};
  double hysteresis_share = 0;  ///< max |forward - back| over the peak [1]
  bool turns = true;            ///< false: a scene without a monitor of a rotation
  double rotation_second = std::numeric_limits<double>::quiet_NaN();  ///< [rad] at the second equilibrium; NaN if none
  double rotation_end = std::numeric_limits<double>::quiet_NaN();     ///< [rad] at the largest travel
  int unstable_points = 0;
  bool bistable = false;
  vehicle::ForceTable table;
};

enum class Verdict { MET, NOT_MET, NOT_DECIDED };
/// "met", "NOT MET", "NOT DECIDED"
const char* nameOf(Verdict verdict);

/// One wish of the vehicle and what the check says of it. A value that depends on the cells is judged where it
/// converges to, error bar included (arm_extrapolation.h), for planar and solid bodies each; where there is nothing to
/// extrapolate from, and for counts, by its range over the bodies without offset.
struct ArmTarget {
  std::string name, wanted;
  double low = 0, high = 0;  ///< what was judged
  bool converged = false;    ///< low .. high are those of an extrapolation
  Verdict verdict = Verdict::NOT_MET;
  bool met() const { return verdict == Verdict::MET; }
};

struct ArmCheck {
  std::vector<ArmCheckCase> cases;
  std::vector<ArmTarget> targets;
  bool bistable = false;  ///< on every re-meshed case, offset ones too
  bool all_met = false;
  bool complete = false;  ///< false: cancelled
  /// The printed body on the finest planar grid; cells outside of it are absent, but one of density 0 on each side of
  /// the domain that it does not reach, so that the list of its cells tells the whole grid.
  mpm::DensityField body;
  /// Curve of one arm in the limit of small cells, for what flies; no points if there is nothing to extrapolate from.
  vehicle::ForceTable table;
  /// The finest planar case of the linear kernel without offset that could be traced; null if none.
  const ArmCheckCase* reference() const;
};

/// @param shape     of the thresholded design
/// @param grey      the optimiser's own field, traced for comparison; empty: not
/// @param progress  gets each case that begins, and "" at every point of a path; true cancels. Cases run side by side
///                  on the settings' threads, but only one at a time asks
ArmCheck checkArm(const ArmDesignSettings& settings, const ArmShape& shape, const mpm::DensityField& grey,
                  const std::function<bool(const std::string&)>& progress);

}  // namespace snapwing::design
