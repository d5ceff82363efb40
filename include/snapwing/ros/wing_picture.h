#pragma once
/// Markers of the designed wings: both linkages and blades at a travel, looked up in the wing's table. Ring frame.

#include <visualization_msgs/MarkerArray.h>

#include "snapwing/vehicle/wing_table.h"

namespace snapwing::nodes {

/// @param table  with a blade (hasBlade()); @param travel  u [m]
/// Adds namespaces "wings" (panels and ribs of the left and right wing) and "linkage" (bars and pins).
void drawDesignedWings(const vehicle::WingTable& table, double travel, visualization_msgs::MarkerArray* out);

}  // namespace snapwing::nodes
