#pragma once
/// Whether the columns of a force table can belong to one elastic arm. A table edited by hand, or written in other
/// units than it says, is found here and not in flight.

#include <string>

#include "snapwing/vehicle/force_table.h"
#include "snapwing/vehicle/vehicle.h"

namespace snapwing::vehicle {

/// Largest shares by which the columns may contradict each other. A table of 1 mm steps has 1e-6 and 1e-3, one of 5 mm
/// steps 3e-4 and 0.02; a wrong unit has 1 and more.
constexpr double ENERGY_ERROR_ALLOWED = 0.02;     ///< sum |dE - integral of R du| over sum |integral of R du|
constexpr double STIFFNESS_ERROR_ALLOWED = 0.15;  ///< rms of dR/du - stiffness over rms of dR/du
constexpr double REST_FORCE_ALLOWED = 0.02;       ///< |R(0)| over the largest |R|

/// Force is the slope of the energy, stiffness the slope of the force, u = 0 an equilibrium.
/// @throws FileError naming the columns, how far they are apart, and where
void requireConsistent(const ForceTable& table, const std::string& path);

/// The table covers limits.travel_min .. travel_max and no more than an arm of this size can reach.
/// @throws FileError
void requireTravelOf(const ForceTable& table, const Vehicle& vehicle, const std::string& path);

}  // namespace snapwing::vehicle
