#pragma once
/// Core types <-> messages. Nothing is computed here that a core type does not hold; units are SI on both sides.

#include <snapwing/ArmGeometry.h>
#include <snapwing/ForceDisplacementCurve.h>
#include <snapwing/ThrustPulse.h>

#include "snapwing/common/force_table.h"
#include "snapwing/common/mode.h"
#include "snapwing/common/pulse.h"
#include "snapwing/common/vehicle.h"

namespace snapwing::nodes {

ThrustPulse toMessage(const common::Pulse& pulse);
common::Pulse fromMessage(const ThrustPulse& message);

std::uint8_t toMessage(common::Mode mode);
/// @throws common::Error if `mode` is none of the enum
common::Mode modeFromMessage(std::uint8_t mode);

/// Vehicle totals (all arms) of a table of one arm, with its features. The header is left empty.
ForceDisplacementCurve curveMessage(const common::ForceTable& table);

/// Geometry of an arm. The outline comes from the table's shapes at rest (empty if it has none); the hash is that of
/// the density file now on disk. @throws common::FileError if the density file cannot be read
ArmGeometry geometryMessage(const common::Vehicle& vehicle, const common::ForceTable& table);

}  // namespace snapwing::nodes
