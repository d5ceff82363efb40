#include "scene_inertia.h"

namespace snapwing::scene {

template <int D>
std::vector<std::vector<int>> SceneInertia<D>::couples() const {
  std::vector<std::vector<int>> all;
  for (const solver::RigidInertiaTerm& term : given_) {
    for (const std::vector<int>& couple : term.couples()) all.push_back(couple);
  }
  return all;
}

template <int D>
void SceneInertia<D>::evaluate(const solver::Point& at, solver::Order order, solver::Sum& sum) const {
  cells_.evaluate(at, order, sum);
  const std::vector<int>* all = sum.couples;
  auto next = all != nullptr ? all->begin() : std::vector<int>::const_iterator();
  for (const solver::RigidInertiaTerm& term : given_) {
    const std::vector<int> own(next, next + D);  // a couple for each component
    next += D;
    sum.couples = &own;
    term.evaluate(at, order, sum);
  }
  sum.couples = all;
}

template <int D>
std::vector<solver::RigidInertiaTerm> givenInertia(const Scene& scene, const Constraints<D>& constraints) {
  std::vector<solver::RigidInertiaTerm> terms;
  for (int body = 0; body < static_cast<int>(scene.bodies.size()); ++body) {
    const GivenMass& given = scene.bodies[body].given;
    if (!(given.mass > 0)) continue;
    const RigidGroup& group = constraints.groupOf(body);
    // In the plane only the moment about z is told: half of it along each axis.
    Eigen::Matrix3d inertia = given.inertia;
    if (D == 2) inertia(0, 0) = inertia(1, 1) = 0.5 * inertia(2, 2);
    terms.emplace_back(group.name, D, group.translation, group.rotation,
                       solver::RigidMass::of(given.mass, Eigen::Vector3d::Zero(), inertia));
  }
  return terms;
}

template <int D>
BodyMass bodyMass(const Scene& scene, const SceneCells<D>& cells, int body) {
  const SceneBody& own = scene.bodies[body];
  BodyMass result;
  Point3 first = Point3::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  if (own.hasCells()) {
    const mpm::Discretisation<D>& solid = *cells.solid();
    for (int c = 0; c < solid.cellCount(); ++c) {
      if (solid.cellBody(c) != body) continue;
      const double density = own.material.mass_density * solid.cell(c).density;
      cells.eachParticle(c, [&](const mpm::Vector<D>& x, const double*, double volume) {
        Point3 p = Point3::Zero();
        p.head<D>() = x;
        result.mass += density * volume;
        first += density * volume * p;
        second += density * volume * p * p.transpose();
      });
    }
    if (result.mass > 0) result.centre = first / result.mass;
    second -= result.mass * result.centre * result.centre.transpose();
    result.inertia = second.trace() * Eigen::Matrix3d::Identity() - second;
  } else {
    result.mass = own.given.mass;
    result.centre = own.given.centre;
    result.inertia = own.given.inertia;
  }
  result.centre = own.frame.toWorld(result.centre);
  if (D == 2) {
    const double about_z = result.inertia(2, 2);
    result.inertia.setZero();
    result.inertia(2, 2) = about_z;
  } else if (own.frame.moved()) {
    result.inertia = (own.frame.rotation * result.inertia * own.frame.rotation.transpose()).eval();
  }
  return result;
}

template class SceneInertia<2>;
template class SceneInertia<3>;
template std::vector<solver::RigidInertiaTerm> givenInertia(const Scene&, const Constraints<2>&);
template std::vector<solver::RigidInertiaTerm> givenInertia(const Scene&, const Constraints<3>&);
template BodyMass bodyMass(const Scene&, const SceneCells<2>&, int);
template BodyMass bodyMass(const Scene&, const SceneCells<3>&, int);

}  // namespace snapwing::scene
