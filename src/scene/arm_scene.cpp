#include "snapwing/scene/arm_scene.h"

#include <cmath>

namespace snapwing::scene {

Scene armScene(const vehicle::Vehicle& vehicle, const mpm::DensityField& field, const ArmSceneSettings& settings) {
  constexpr double ROTATION_RADIUS = 0.004;
  const vehicle::ArmSettings& arm = vehicle.arm;
  Scene scene;
  scene.name = vehicle.name + " arm";
  scene.dimension = settings.dimension;
  scene.plane = settings.plane;
  scene.kernel = settings.kernel;
  scene.cell_size = field.cell_size;
  scene.particles = 4;
  SceneBody body;
  body.name = "arm";
  body.material = {vehicle.material.youngs_modulus.value, vehicle.material.poisson_ratio.value,
                   vehicle.material.mass_density.value};
  body.density = field;
  body.thickness = arm.bar_thickness;
  mpm::Box leg;
  leg.low(0) = 0, leg.high(0) = arm.leg_width;
  body.thickness_in = {{leg, arm.leg_thickness}};
  scene.bodies.push_back(body);
  scene.pins.push_back({"axle", 0, arm.pin_x, arm.pin_y, PinKind::LINE, 0});
  ScenePort housing;
  housing.name = "housing";
  housing.region.low.head<2>() << 0, arm.clamp_y_low;
  housing.region.high.head<2>() << 0, arm.clamp_y_high;
  housing.direction = {0, -1, 0};
  scene.ports.push_back(housing);
  SceneMonitor rotation;
  rotation.name = "arm_rotation";
  rotation.at = {arm.pin_x, arm.pin_y, 0};
  rotation.radius = ROTATION_RADIUS;
  scene.monitors.push_back(rotation);
  scene.to = vehicle.limits.travel_max;
  scene.steps = static_cast<int>(std::ceil(scene.to / settings.step - 1e-9));
  scene.back = settings.back;
  return scene;
}

}  // namespace snapwing::scene
