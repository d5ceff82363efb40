#pragma once
/// The paper's arm: an L of 80 x 40 mm, four of them, bar twice as thick as the leg.

#include "snapwing/vehicle/vehicle.h"

namespace snapwing::testing {

inline vehicle::ArmSettings exampleArm() {
  vehicle::ArmSettings arm;
  arm.count = 4;
  arm.domain_length = 0.08;
  arm.domain_height = 0.04;
  arm.leg_width = arm.bar_height = 0.02;
  arm.leg_thickness = 0.005;
  arm.bar_thickness = 0.01;
  arm.pin_x = 0.078;
  arm.pin_y = 0.002;
  arm.clamp_y_low = 0.02;
  arm.clamp_y_high = 0.04;
  return arm;
}

}  // namespace snapwing::testing
