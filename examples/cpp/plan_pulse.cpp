// Finds a pulse that switches every vehicle of the box: plan_pulse VEHICLE.yaml F|Q
#include <cstdio>

#include "snapwing/common/error.h"
#include "snapwing/planning/pulse_planner.h"
#include "snapwing/vehicle/table_origin.h"

int main(int argc, char** argv) {
  if (argc != 3) return std::fprintf(stderr, "usage: plan_pulse VEHICLE.yaml F|Q\n"), 2;
  try {
    using namespace snapwing;
    const vehicle::Vehicle drone = vehicle::loadVehicle(argv[1]);
    const vehicle::ForceTable table = vehicle::armTableOf(drone);
    const planning::PulsePlanner planner(drone, table, {}, vehicle::wingTableOf(drone, table));
    const auto plan = planner.plan(vehicle::modeFromName(argv[2]), vehicle::Trial());
    if (!plan.accepted) return std::printf("refused: %s\n", plan.reason.c_str()), 1;
    std::printf("throttle %.3f for %.3f s, worst margin %.3f over %d vehicles\n", plan.pulse.throttle,
                plan.pulse.duration, plan.worst_margin, plan.realisations);
    return 0;
  } catch (const snapwing::common::Error& error) {
    return std::fprintf(stderr, "error: %s\n", error.what()), 2;
  }
}
