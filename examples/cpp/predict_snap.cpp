// Says what a pulse does to a vehicle: predict_snap VEHICLE.yaml THROTTLE SECONDS
#include <cstdio>
#include <cstdlib>

#include "snapwing/common/error.h"
#include "snapwing/rom/lumped_model.h"
#include "snapwing/vehicle/table_origin.h"

int main(int argc, char** argv) {
  if (argc != 4) return std::fprintf(stderr, "usage: predict_snap VEHICLE.yaml THROTTLE SECONDS\n"), 2;
  try {
    using namespace snapwing;
    const vehicle::Vehicle drone = vehicle::loadVehicle(argv[1]);
    const vehicle::ForceTable table = vehicle::armTableOf(drone);  // refused if it belongs to another arm
    const auto model = rom::LumpedModel::fromVehicle(drone, table, vehicle::realise(drone, table), {},
                                                     vehicle::wingTableOf(drone, table));
    vehicle::Pulse pulse;
    pulse.throttle = std::atof(argv[2]);
    pulse.duration = std::atof(argv[3]);
    const auto told = model.predict(vehicle::Mode::FIXED_WING, pulse, drone.radio, vehicle::Trial());
    std::printf("%s, snap at %.4f s, margin %.3f of the barrier%s\n", told.snapped ? "switches" : "does not switch",
                told.snap_time, told.energy_margin, told.out_of_table ? ", out of the table" : "");
    return 0;
  } catch (const snapwing::common::Error& error) {
    return std::fprintf(stderr, "error: %s\n", error.what()), 2;
  }
}
