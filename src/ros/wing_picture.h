#pragma once
/// Markers of the designed wings: both linkages and blades at a travel, looked up in the wing's table. Ring frame.

#include <visualization_msgs/MarkerArray.h>

#include <array>

#include "snapwing/vehicle/wing_table.h"

namespace snapwing::nodes {

/// @param table  with a blade (hasBlade()); @param travel  u [m] of the left and the right wing
/// Adds namespaces "wings" (panels and ribs of the left and right wing) and "linkage" (bars and pins).
void drawDesignedWings(const vehicle::WingTable& table, const std::array<double, 2>& travel,
                       visualization_msgs::MarkerArray* out);

/// Travel [m] at which the table has a wing at `angle` [rad], 0 unfolded, positive as it folds; an angle beyond the
/// table's is drawn as the nearest that it has.
double travelOfWingAngle(const vehicle::WingTable& table, double angle);

}  // namespace snapwing::nodes
