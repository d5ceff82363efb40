#include "snapwing/scene/arm_scene.h"

#include <cmath>
#include <string>

#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"

namespace snapwing::scene {

void ArmSceneSettings::validate() const {
  const auto refuse = [](const char* name, double value, const char* allowed) {
    throw common::Error(std::string(name) + " is " + common::toText(value) + " m; allowed: " + allowed);
  };
  if (!(from <= 0)) refuse("from", from, "<= 0");
  if (!(to > 0)) refuse("to", to, "> 0");
  if (!(step > 0 && step <= to / 3)) refuse("step", step, "> 0 and at most a third of 'to'");
}

Scene armScene(const vehicle::Vehicle& vehicle, const mpm::DensityField& field, const ArmSceneSettings& settings) {
  constexpr double ROTATION_RADIUS = 0.004;
  const vehicle::ArmSettings& arm = vehicle.arm;
  Scene scene;
  scene.name = vehicle.name + " arm";
  scene.dimension = settings.dimension;
  scene.plane = settings.plane;
  scene.kernel = settings.kernel;
  const double cell = settings.cell_size > 0 ? settings.cell_size : field.cell_size;
  const bool same = std::abs(cell - field.cell_size) <= 1e-9 * field.cell_size;
  scene.cell_size = same ? field.cell_size : cell;
  scene.particles = 4;
  SceneBody body;
  body.name = "arm";
  body.material = {vehicle.material.youngs_modulus.value, vehicle.material.poisson_ratio.value,
                   vehicle.material.mass_density.value};
  body.density = same ? field : field.resampled(cell);
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
  scene.to = settings.to > 0 ? settings.to : vehicle.limits.travel_max;
  scene.steps = stepCount(scene.to, settings.step);
  scene.from = settings.from;
  scene.from_steps = stepCount(scene.from, settings.step);
  scene.back = settings.back;
  return scene;
}

}  // namespace snapwing::scene
