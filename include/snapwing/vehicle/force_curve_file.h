#pragma once
/// Force tables without the arm's outlines, which only pictures need: most of a file's bytes, and of the time to read
/// it.

#include <string>

#include "snapwing/vehicle/force_table.h"
#include "snapwing/vehicle/vehicle.h"

namespace snapwing::vehicle {

/// As loadForceTable, with empty `shapes`; those of the file are not looked at.
ForceTable loadForceCurve(const std::string& path);

/// As armTableOf, same.
ForceTable armCurveOf(const Vehicle& vehicle, const std::string& path = {});

}  // namespace snapwing::vehicle
