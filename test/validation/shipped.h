#pragma once
/// The shipped vehicle with its tables.

#include <optional>

#include "snapwing/vehicle/table_origin.h"
#include "support/paths.h"

namespace snapwing::validation {

struct Shipped {
  vehicle::Vehicle vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  vehicle::ForceTable table = vehicle::armTableOf(vehicle);
  std::optional<vehicle::WingTable> wing = vehicle::wingTableOf(vehicle, table);
};

}  // namespace snapwing::validation
