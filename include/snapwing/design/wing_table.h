#pragma once
/// Filling the wing's table (common/wing_table.h) from a designed linkage.

#include <optional>

#include "snapwing/common/wing_table.h"
#include "snapwing/design/linkage_four_bar.h"
#include "snapwing/design/wing_arm_motion.h"
#include "snapwing/design/wing_blade.h"

namespace snapwing::design {

using common::loadWingTable;
using common::saveWingTable;
using common::WingTable;

/// Rigid table at equal steps of u. @param largest  last travel [m]; @param points  at least 2
/// @return none if the loop does not close somewhere on the way
std::optional<WingTable> tabulate(const FourBar& bar, const ArmMotion& motion, double largest, int points);

/// Adds the blade's columns: where its edges are, the inertia of both wings, and the force of friction at the pins.
/// @throws common::Error if the loop of the blade's linkage opens within the table
void addBlade(const WingBlade& blade, const ArmMotion& motion, WingTable* table);

}  // namespace snapwing::design
