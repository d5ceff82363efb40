#pragma once
/// Filling the wing's table (vehicle/wing_table.h) from a designed linkage.

#include <optional>

#include "snapwing/design/wing/linkage_four_bar.h"
#include "snapwing/design/wing/wing_arm_motion.h"
#include "snapwing/design/wing/wing_blade.h"
#include "snapwing/vehicle/wing_table.h"

namespace snapwing::design {

using vehicle::loadWingTable;
using vehicle::saveWingTable;
using vehicle::WingTable;

/// Rigid table at equal steps of u. @param largest  last travel [m]; @param points  at least 2
/// @return none if the loop does not close somewhere on the way
std::optional<WingTable> tabulate(const FourBar& bar, const ArmMotion& motion, double largest, int points);

/// Adds the blade's columns: where its edges are, the inertia of both wings, and the force of friction at the pins.
/// @throws common::Error if the loop of the blade's linkage opens within the table
void addBlade(const WingBlade& blade, const ArmMotion& motion, WingTable* table);

}  // namespace snapwing::design
