#include "design_scene.h"

#include <algorithm>
#include <cmath>

#include "snapwing/common/elementary.h"
#include "snapwing/common/error.h"
#include "snapwing/design/arm/mechanism.h"
#include "snapwing/scene/arm_scene.h"

namespace snapwing::design {

namespace {

scene::Scene baseScene(const ArmDesignSettings& s) {
  return s.user_scene ? s.scene : scene::armScene(s.vehicle, {}, {});
}

}  // namespace

mpm::DensityField armDomain(const vehicle::ArmSettings& arm, double cell_size, double density) {
  mpm::DensityField field;
  field.cell_size = cell_size;
  const auto whole = [&](double length, const char* name) {
    const double cells = length / cell_size;
    if (std::abs(cells - std::round(cells)) > 1e-6 || cells < 1) {
      throw common::Error("cell_size " + std::to_string(cell_size) + " m does not divide " + name + " = " +
                          std::to_string(length) + " m");
    }
    return static_cast<int>(std::lround(cells));
  };
  field.cells = {whole(arm.domain_length, "domain_length"), whole(arm.domain_height, "domain_height")};
  const int leg = whole(arm.leg_width, "leg_width"), bar = whole(arm.bar_height, "bar_height");
  for (int j = 0; j < field.cells[1]; ++j) {
    for (int i = 0; i < field.cells[0]; ++i) field.value.push_back(i < leg || j < bar ? density : -1.0);
  }
  return field;
}

mpm::DensityField designDomain(const ArmDesignSettings& s, double cell_size, double density) {
  if (!s.user_scene) return armDomain(s.vehicle.arm, cell_size, density);
  SceneRung rung;
  rung.cell_size = cell_size;
  const Mechanism whole(designScene(s, rung, nullptr), s.body, 1);
  return whole.field(Eigen::VectorXd::Constant(whole.columnCount(), density));
}

scene::Scene designScene(const ArmDesignSettings& s, const SceneRung& rung, const mpm::DensityField* field) {
  scene::Scene scene = baseScene(s);
  scene.dimension = rung.volumetric ? 3 : 2;
  scene.plane = s.plane;
  scene.kernel = rung.quadratic    ? scene::SceneKernel::QUADRATIC
                 : rung.volumetric ? scene::SceneKernel::LINEAR_REDUCED
                                   : scene::SceneKernel::LINEAR;
  scene.cell_size = rung.cell_size;
  scene.particles = 4;
  scene.interpolation.threshold = s.void_threshold;
  scene.steps = scene::stepCount(scene.to, rung.step);
  scene.from = rung.from;
  scene.from_steps = scene::stepCount(scene.from, rung.step);
  scene.back = true;
  scene.enforcement = solver::Enforcement::ELIMINATION;  // exact, and the adjoint knows it
  // A design need not be symmetric in its plane, and its forces are those of one copy. Half the thickness at any cell
  // size: a line pin lets the whole one slide along the axle, and a compressed arm then sways sideways.
  scene.use_symmetry = scene::SymmetryUse::MIDDLE;
  scene.copies = 1;
  scene::SceneBody& body = scene.bodies[s.body];
  if (field) {
    body.density = *field;
    body.shape = nullptr;
  } else if (!s.user_scene) {
    body.density = armDomain(s.vehicle.arm, rung.cell_size, 1.0);
  }
  return scene;
}

std::array<double, 2> designSeed(const ArmDesignSettings& s) {
  if (!s.user_scene) return {s.vehicle.arm.pin_x, s.vehicle.arm.pin_y};
  const mpm::Box bounds = s.scene.bodies[s.body].shape->bounds();
  for (const scene::ScenePort& port : s.scene.ports) {
    if (port.body != s.body) continue;
    const mpm::Point3 low = port.region.low.cwiseMax(bounds.low), high = port.region.high.cwiseMin(bounds.high);
    return {0.5 * (low(0) + high(0)), 0.5 * (low(1) + high(1))};
  }
  throw common::Error("no port drives the designed body '" + s.scene.bodies[s.body].name + "'");
}

Eigen::VectorXd designPatches(const ArmDesignSettings& s, const std::vector<std::array<double, 2>>& centres) {
  const scene::Scene scene = baseScene(s);
  Eigen::VectorXd held = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(centres.size()), -1);
  for (std::size_t k = 0; k < centres.size(); ++k) {
    const mpm::Point3 x(centres[k][0], centres[k][1], 0);
    bool solid = false;
    for (const scene::ScenePin& pin : scene.pins) {
      solid = solid || (pin.body == s.body && common::hypot(x(0) - pin.x, x(1) - pin.y) < s.pin_patch);
    }
    for (const scene::ScenePort& port : scene.ports) {
      mpm::Box strip = port.region;
      for (int a = 0; a < 2; ++a) {
        if (strip.low(a) != strip.high(a)) continue;
        strip.low(a) -= s.clamp_patch, strip.high(a) += s.clamp_patch;
      }
      solid = solid || (port.body == s.body && s.clamp_patch > 0 && strip.contains(x));
    }
    if (solid) held(static_cast<Eigen::Index>(k)) = 1;
  }
  return held;
}

}  // namespace snapwing::design
