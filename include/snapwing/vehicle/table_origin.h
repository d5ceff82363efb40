#pragma once
/// Which arm a force table or a wing table belongs to: stored when the table is computed, compared with the vehicle
/// file when it is used. Only inputs of the curve are compared: density, geometry and material of the arm. Everything
/// else in a vehicle file (masses, rotors, battery, limits) may change without a new table.

#include <map>
#include <optional>
#include <string>

#include "snapwing/vehicle/force_table.h"
#include "snapwing/vehicle/vehicle.h"
#include "snapwing/vehicle/wing_table.h"

namespace snapwing::vehicle {

/// Stores the inputs of the curve of the vehicle's arm: "density_sha256", "youngs_modulus_pa", "poisson_ratio",
/// "mass_density_kg_m3", "arm_count", and "inputs_sha256" over density, geometry and elastic constants.
/// @param density  bytes of the density file; @param provenance  out
void noteOrigin(const Vehicle& vehicle, const std::string& density, std::map<std::string, std::string>* provenance);

/// Requires that a force table belongs to the vehicle's arm. @param path  of the table, for messages
/// @throws FileError naming the input that differs, both values, and the command that computes the table again. A table
/// without provenance is refused as well, unless it states origin = "measured"
void requireOrigin(const ForceTable& table, const Vehicle& vehicle, const std::string& path);

/// Requires that a wing table's rotation of the arm and position of the axle are those of the vehicle.
/// @throws FileError naming what differs, both values, and the command that computes the table again
void requireOrigin(const WingTable& wing, const ForceTable& arm, const Vehicle& vehicle);

/// The vehicle's force table after all checks: it exists, belongs to the vehicle's arm, is consistent, and covers the
/// vehicle's limits.
/// @param path  another table of the same arm; empty: the one that the vehicle file names
/// @throws FileError, SettingError
ForceTable armTableOf(const Vehicle& vehicle, const std::string& path = {});

/// The table of the vehicle's wings after all checks. @return none if the vehicle has no wings
/// @throws FileError, SettingError
std::optional<WingTable> wingTableOf(const Vehicle& vehicle, const ForceTable& arm);

/// Requires that a file exists which the vehicle file names.
/// @param key      of the vehicle file, e.g. "arm.density_file"; @param path  its value, absolute
/// @param remedy   how to make the file
/// @throws SettingError naming key, path and remedy
void requireFileOf(const Vehicle& vehicle, const std::string& key, const std::string& path, const std::string& remedy);

/// Bytes of the file that arm.density_file names. @throws SettingError if it is not there; FileError
std::string densityBytesOf(const Vehicle& vehicle);

}  // namespace snapwing::vehicle
