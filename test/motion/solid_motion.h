#pragma once
/// Solids in time for tests: a scene's problem with its inertia and what a test adds.

#include <memory>
#include <string>
#include <vector>

#include "one_mode.h"
#include "snapwing/scene/scene_problem.h"

namespace snapwing::test {

/// One body in a planar scene, quadratic kernel.
inline scene::Scene planarScene(const std::string& name, mpm::ShapePtr shape, double cell_size,
                                const elasticity::Material& material, double thickness,
                                elasticity::Plane plane = elasticity::Plane::STRAIN) {
  scene::Scene scene;
  scene.name = name;
  scene.dimension = 2;
  scene.plane = plane;
  scene.kernel = scene::SceneKernel::QUADRATIC;
  scene.cell_size = cell_size;
  scene.use_symmetry = scene::SymmetryUse::NONE;
  scene::SceneBody body;
  body.name = "body";
  body.material = material;
  body.shape = std::move(shape);
  body.thickness = thickness;
  scene.bodies.push_back(body);
  scene.control_is_length = false;
  scene.to = 1, scene.steps = 1;
  return scene;
}

inline mpm::Box boxOf(double x0, double x1, double y0, double y1) {
  mpm::Box box;
  box.low.head<2>() << x0, y0;
  box.high.head<2>() << x1, y1;
  return box;
}

inline std::shared_ptr<const solver::TermProblem> inTime(const scene::CompiledScene& scene,
                                                         std::vector<std::shared_ptr<const solver::Term>> more = {}) {
  more.insert(more.begin(), scene.inertia(mpm::MassKind::CONSISTENT));
  return scene.sharedTerms()->with(more);
}

inline motion::ControlOf constantControl(double value) {
  return [value](double, double) { return Eigen::VectorXd::Constant(1, value); };
}

}  // namespace snapwing::test
