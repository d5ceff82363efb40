#pragma once
/// Mass of a scene's bodies (internal to the layer).

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "scene_constraints.h"
#include "snapwing/scene/scene_problem.h"
#include "snapwing/solver/inertia_term.h"
#include "snapwing/solver/rigid_inertia_term.h"

namespace snapwing::scene {

/// Inertia of the cells, and of the bodies without any.
template <int D>
class SceneInertia : public solver::Term {
 public:
  SceneInertia(std::shared_ptr<const mpm::Mass<D>> mass, std::vector<solver::RigidInertiaTerm> given)
      : cells_(std::move(mass)), given_(std::move(given)) {}
  std::string name() const override { return cells_.name(); }
  Role role() const override { return Role::INERTIA; }
  int region() const override { return cells_.region(); }
  std::vector<std::vector<int>> couples() const override;
  void evaluate(const solver::Point& at, solver::Order order, solver::Sum& sum) const override;

 private:
  solver::InertiaTerm<D> cells_;
  std::vector<solver::RigidInertiaTerm> given_;
};

/// Of the bodies without cells.
template <int D>
std::vector<solver::RigidInertiaTerm> givenInertia(const Scene& scene, const Constraints<D>& constraints);

/// Mass, centre and inertia of one body at the densities of its cells, where it lies at rest.
template <int D>
BodyMass bodyMass(const Scene& scene, const SceneCells<D>& cells, int body);

}  // namespace snapwing::scene
