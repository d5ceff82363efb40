#pragma once
/// How close the folding wing comes to the propellers. Propellers are thin discs over the ring, at equal angles and
/// half a step from the arms; bars are lines with half their width, the leading edge with its radius, the blade's
/// panels triangles. Distances from points on these to the discs:  d = |(max(0, rho - R), z - h)|.

#include "snapwing/design/wing/wing_blade.h"
#include "snapwing/vehicle/vehicle.h"

namespace snapwing::design {

struct WingClearance {
  double bars = 0;      ///< smallest over the travel, of bars and leading edge [m]; negative: they touch
  double bars_at = 0;   ///< arm rotation of it [rad]
  double blade = 0;     ///< of the panels [m]
  double blade_at = 0;  ///< [rad]
};

/// @param rotor_height  of the discs over the ring's middle [m]
WingClearance clearanceOf(const WingBlade& blade, const vehicle::Vehicle& vehicle, double rotor_height = 0.028);

}  // namespace snapwing::design
