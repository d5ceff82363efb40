#pragma once
/// The static curve of an arm's body, traced again as a solid in the plane, beside the table that the model predicts
/// with.

#include <functional>
#include <string>
#include <vector>

#include "snapwing/validation/check.h"
#include "snapwing/vehicle/force_table.h"
#include "snapwing/vehicle/vehicle.h"

namespace snapwing::validation {

/// Force of all arms against travel. Where the travel turns back the arm has an internal snap: at a given travel it has
/// several states, and jumps between them.
struct ArmCurve {
  double cell_size = 0;               ///< [m]
  std::string failure;                ///< why the path ended early; empty: it is whole
  std::vector<double> travel, force;  ///< [m], [N] along the path
  std::vector<double> turns;          ///< [m] travels where it turns
  int unstable = 0;                   ///< points that are no minimum at their travel
  double min_det_f = 1;
  bool bistable = false;
  double peak_force = 0, valley_force = 0, barrier_travel = 0, second_travel = 0;  ///< [N], [m]; 0 without a whole path
};

/// @param body       density file [CSV] of the arm as it is made
/// @param cell_size  [m]; cells that are coarser than the file's keep its stiffness
/// @param cancelled  polled; true ends the path
/// @throws common::Error for a file that is none
ArmCurve traceArm(const vehicle::Vehicle& vehicle, const std::string& body, double cell_size,
                  const std::function<bool()>& cancelled = {});

/// A number of the curves in the limit of small cells; of one curve alone it is that curve's, without an error bar.
Estimate estimateOf(const std::vector<ArmCurve>& curves, double ArmCurve::*member);

/// What must hold: a whole path, no internal snap, two stable states, and a peak that the table's arm may have by
/// arm.force_scale. The second equilibrium lies within 2 mm of the table's.
/// @param curves  of one body, coarser cells first: one or two. What the two do not agree on is undecided
std::vector<Check> checkCurve(const std::vector<ArmCurve>& curves, const vehicle::ForceTable& table,
                              const vehicle::Vehicle& vehicle);

}  // namespace snapwing::validation
