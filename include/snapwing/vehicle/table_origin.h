#pragma once
/// Which arm a force table belongs to, and which arm a wing's table: noted when a table is computed, compared with the
/// vehicle file when it is used. Only what the curve depends on is compared: density, geometry and material of the arm.
/// Everything else in a vehicle file (masses, rotors, battery, limits) may change without a new table.

#include <map>
#include <optional>
#include <string>

#include "snapwing/vehicle/force_table.h"
#include "snapwing/vehicle/vehicle.h"
#include "snapwing/vehicle/wing_table.h"

namespace snapwing::vehicle {

/// Notes what the curve of the vehicle's arm is computed from: "density_sha256", "youngs_modulus_pa", "poisson_ratio",
/// "mass_density_kg_m3", "arm_count", and "inputs_sha256" over density, geometry and elastic constants.
/// @param density  bytes of the density file
void noteOrigin(const Vehicle& vehicle, const std::string& density, std::map<std::string, std::string>* provenance);

/// @param path  of the table, for messages
/// @throws FileError naming what differs, both values, and the command that computes the table again; a table without
/// provenance is refused too, unless it says origin = "measured"
void requireOrigin(const ForceTable& table, const Vehicle& vehicle, const std::string& path);

/// A wing's table holds the arm's rotation against travel and where the axle is: both must be the vehicle's own.
/// @throws FileError naming what differs, both values, and the command that computes the table again
void requireOrigin(const WingTable& wing, const ForceTable& arm, const Vehicle& vehicle);

/// The vehicle's force table after every check: it is there, it belongs to the vehicle's arm, it is physical, and it
/// covers the vehicle's limits.
/// @param path  another table of the same arm in place of the one that the vehicle file names; empty: that one
/// @throws FileError, SettingError
ForceTable armTableOf(const Vehicle& vehicle, const std::string& path = {});

/// The table of the vehicle's wings after every check. @return none if the vehicle has no wings
/// @throws FileError, SettingError
std::optional<WingTable> wingTableOf(const Vehicle& vehicle, const ForceTable& arm);

/// @param key      of the vehicle file, e.g. "arm.density_file"; @param path  what it says, absolute
/// @param remedy   what makes the file
/// @throws SettingError if there is no such file, naming key, path and remedy
void requireFileOf(const Vehicle& vehicle, const std::string& key, const std::string& path, const std::string& remedy);

/// Bytes of the file that arm.density_file names. @throws SettingError if it is not there; FileError
std::string densityBytesOf(const Vehicle& vehicle);

}  // namespace snapwing::vehicle
