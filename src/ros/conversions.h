#pragma once
/// Core types <-> messages. Nothing is computed here that a core type does not hold; units are SI on both sides.

#include <snapwing/ArmGeometry.h>
#include <snapwing/ForceDisplacementCurve.h>
#include <snapwing/ThrustPulse.h>

#include "snapwing/vehicle/force_table.h"
#include "snapwing/vehicle/mode.h"
#include "snapwing/vehicle/pulse.h"
#include "snapwing/vehicle/vehicle.h"

namespace snapwing::nodes {

ThrustPulse toMessage(const vehicle::Pulse& pulse);
vehicle::Pulse fromMessage(const ThrustPulse& message);

std::uint8_t toMessage(vehicle::Mode mode);
/// @throws common::Error if `mode` is none of the enum
vehicle::Mode modeFromMessage(std::uint8_t mode);

/// Vehicle totals (all arms) of a table of one arm, with its features. The header is left empty.
ForceDisplacementCurve curveMessage(const vehicle::ForceTable& table);

/// Geometry of an arm. The outline comes from the table's shapes at rest (empty if it has none); the hash is that of
/// the density file now on disk. @throws common::FileError if the density file cannot be read
ArmGeometry geometryMessage(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table);

}  // namespace snapwing::nodes
