#pragma once
/// Checks whether the columns of a force table can belong to one elastic arm, so that a table edited by hand, or with
/// wrong units, is refused before a flight.

#include <string>

#include "snapwing/vehicle/force_table.h"
#include "snapwing/vehicle/vehicle.h"

namespace snapwing::vehicle {

/// Largest relative errors between the columns. A table of 1 mm steps has 1e-6 (energy) and 1e-3 (stiffness), one of
/// 5 mm steps 3e-4 and 0.02; with a wrong unit they are 1 and more.
constexpr double ENERGY_ERROR_ALLOWED = 0.02;     ///< sum |dE - integral of R du| over sum |integral of R du|
constexpr double STIFFNESS_ERROR_ALLOWED = 0.15;  ///< rms of dR/du - stiffness over rms of dR/du
constexpr double REST_FORCE_ALLOWED = 0.02;       ///< |R(0)| over the largest |R|

/// K / m at most: parts of an arm may move farther than the housing, but not on the average of all of them (1.2 in the
/// shipped table).
constexpr double KINETIC_SHARE_ALLOWED = 10;

/// Requires that the force is the derivative of the energy, the stiffness that of the force, u = 0 an equilibrium, and
/// the kinetic mass one that the arm's mass can have.
/// @throws FileError naming the columns, their difference, and where
void requireConsistent(const ForceTable& table, const std::string& path);

/// Requires that the table covers limits.travel_min .. travel_max, and no more than an arm of this size can reach.
/// @throws FileError
void requireTravelOf(const ForceTable& table, const Vehicle& vehicle, const std::string& path);

/// Requires that the arms are no heavier than the ring side of the vehicle, which contains them. @throws FileError
void requireMassOf(const ForceTable& table, const Vehicle& vehicle, const std::string& path);

}  // namespace snapwing::vehicle
