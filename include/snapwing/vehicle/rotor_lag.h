#pragma once
/// First-order lag of thrust, exact over an interval with constant demand.

#include <cmath>

namespace snapwing::vehicle {

struct LaggedThrust {
  double end = 0;   ///< [N]
  double mean = 0;  ///< over the interval [N]
};

/// @param now, wanted  thrust at the start, and demand [N]
/// @param time_up, time_down  time constants while thrust rises and falls [s] > 0; @param dt  length [s] > 0
inline LaggedThrust laggedThrust(double now, double wanted, double time_up, double time_down, double dt) {
  const double lag = wanted > now ? time_up : time_down;
  const double decay = -std::expm1(-dt / lag);
  return {now + (wanted - now) * decay, wanted + (now - wanted) * decay * lag / dt};
}

}  // namespace snapwing::vehicle
