#pragma once
/// Force tables without the arm's outlines. The outlines are needed only for pictures, and take most of a file's bytes
/// and of the time to read it.

#include <string>

#include "snapwing/vehicle/force_table.h"
#include "snapwing/vehicle/vehicle.h"

namespace snapwing::vehicle {

/// As loadForceTable, without reading `shapes`.
ForceTable loadForceCurve(const std::string& path);

/// As armTableOf, without reading `shapes`.
ForceTable armCurveOf(const Vehicle& vehicle, const std::string& path = {});

}  // namespace snapwing::vehicle
