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

/// A vehicle that states no more than what an arm's scene asks for.
inline vehicle::Vehicle exampleArmVehicle() {
  vehicle::Vehicle vehicle;
  vehicle.name = "example";
  vehicle.arm = exampleArm();
  vehicle.material.youngs_modulus.value = 5.5e6;
  vehicle.material.poisson_ratio.value = 0.48;
  vehicle.material.mass_density.value = 1210;
  vehicle.limits = {-0.015, 0.08};
  return vehicle;
}

}  // namespace snapwing::testing
