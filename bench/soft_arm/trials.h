#pragma once
/// The same trial on the boom with the soft arm and with the lumped model, and the pulse at which each switches.

#include "snapwing/rom/lumped_model.h"
#include "soft_arm.h"

namespace snapwing::bench {

/// A body of the vehicle's arm with its own force table.
struct ArmBody {
  ArmBody(const vehicle::Vehicle& vehicle, double cell_size, double least_density, double travel_step);
  vehicle::Vehicle vehicle;
  std::unique_ptr<scene::CompiledScene> arm;
  vehicle::ForceTable table;
  vehicle::VehicleParameters parameters;
};

struct Outcome {
  vehicle::Mode end = vehicle::Mode::UNKNOWN;
  double snap_time = NAN;  ///< [s] after the command, last crossing of the unloaded barrier
  double peak = 0;         ///< [m]
  bool failed = false;     ///< the integration gave up
};

/// Starts at rest with stopped motors; the pulse comes after the latency.
/// @param fraction  steady thrust / full thrust; @param dt  [s]
Outcome softTrial(const ArmBody& body, vehicle::Mode start, double fraction, double duration, double dt);
Outcome lumpedTrial(const rom::LumpedModel& model, vehicle::Mode start, double fraction, double duration);

/// Shortest pulse that switches, by bisection. @param low, high  [s] the outcome differs between them
double threshold(double low, double high, int halvings, const std::function<Outcome(double)>& trial,
                 vehicle::Mode start);

}  // namespace snapwing::bench
