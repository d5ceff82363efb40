// Loads of a scene: tractions that grow with the control, constant ones, weight.
#include <algorithm>
#include <cmath>

#include "scene_constraints.h"
#include "scene_weight.h"
#include "snapwing/common/error.h"

namespace snapwing::scene {

using mpm::Vector;

namespace {

constexpr double NEAR = 1e-6;  // cells: closer is the same place

/// In what a plane splits the surroundings of a point: +1 material below and void above, -1 the other way, 0 no
/// surface.
template <int D>
int surfaceAt(const SceneCells<D>& cells, int body, Vector<D> x, int axis, double step) {
  const double at = x(axis);
  x(axis) = at - step;
  const bool below = cells.contains(body, x);
  x(axis) = at + step;
  return (below ? 1 : 0) - (cells.contains(body, x) ? 1 : 0);
}

}  // namespace

/// Share of each node in a uniform traction, by samples on the part of the plane that is the body's surface. Of two
/// cells that share the plane the one on the side of the material carries it; in the plane a sample counts as much as
/// the slice is thick there.
template <int D>
Eigen::VectorXd Constraints<D>::faceWeights(const SceneLoad& load) const {
  const int axis = flatAxis<D>(load.region);
  if (axis < 0) throw common::Error("'" + load.name + "': the region of a load must be flat along one axis");
  const mpm::Grid<D>& grid = solid_.grid(load.body);
  const SceneBody& body = scene_.bodies[load.body];
  const int n = 4;
  const int samples = D == 2 ? n : n * n;
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(solid_.nodeCount()), value;
  Eigen::Matrix<double, D, Eigen::Dynamic> slope;
  double total = 0;
  bool met = false;
  for (int c = 0; c < solid_.cellCount(); ++c) {
    if (solid_.cellBody(c) != load.body) continue;
    const Vector<D> centre = grid.cellCentre(solid_.cellAt(c));
    const Vector<D> low = centre - Vector<D>::Constant(0.5 * grid.cell_size);
    const double along = (load.region.low(axis) - low(axis)) / grid.cell_size;
    if (along < -NEAR || along > 1 + NEAR) continue;
    const double share = D == 2 ? body.thicknessAt(centre(0), centre(1)) / body.thickness : 1.0;
    for (int s = 0; s < samples; ++s) {
      Vector<D> local;
      for (int a = 0, rest = s; a < D; ++a) {
        if (a == axis) continue;
        local(a) = (rest % n + 0.5) / n;
        rest /= n;
      }
      local(axis) = std::min(std::max(along, 0.0), 1.0);
      const Vector<D> x = low + grid.cell_size * local;
      Point3 p = Point3::Zero();
      p.head<D>() = x;
      if (!load.region.contains(p, NEAR * grid.cell_size)) continue;
      met = true;
      const int normal = surfaceAt<D>(cells_, load.body, x, axis, 2 * NEAR * grid.cell_size);
      const bool behind = (normal > 0 && along < NEAR) || (normal < 0 && along > 1 - NEAR);
      if (normal == 0 || behind) continue;
      grid.weights(local, value, slope);
      for (int a = 0; a < solid_.stencil(); ++a) weights(solid_.cellNodes(c)[a]) += share * value(a);
      total += share;
    }
  }
  if (total > 0) return weights / total;
  throw common::Error("'" + load.name + "' meets no " + (met ? "surface" : "material") + " of body '" + body.name +
                      "'" + (met ? ": the plane lies inside the body" : "") +
                      "; allowed: a plane on which the body ends, at the place of its surface");
}

template <int D>
typename Constraints<D>::Weights Constraints<D>::loadWeights(const SceneLoad& load) const {
  if (!scene_.bodies[load.body].hasCells()) return pointWeights(load.body, load.at.template head<D>());
  const Eigen::VectorXd weights = faceWeights(load);
  Weights result;
  for (int node = 0; node < solid_.nodeCount(); ++node) {
    if (weights(node) != 0) result.emplace_back(node, weights(node));
  }
  return result;
}

template <int D>
int Constraints<D>::loadSize() const {
  const auto given = [](const SceneBody& b) { return !b.hasCells(); };
  return std::any_of(scene_.bodies.begin(), scene_.bodies.end(), given) ? dofCount() : solid_.dofCount();
}

template <int D>
Eigen::MatrixXd Constraints<D>::loads() const {
  Eigen::MatrixXd result;
  for (const SceneLoad& load : scene_.loads) {
    if (load.constant) continue;
    if (result.size() == 0) result = Eigen::MatrixXd::Zero(loadSize(), 1);
    for (const auto& [node, weight] : loadWeights(load)) {
      for (int a = 0; a < D; ++a) result(D * node + a, 0) += weight * load.force(a);
    }
  }
  return result / cells_.multiplicity();
}

template <int D>
Weight<D>::Weight(const Scene& scene, const SceneCells<D>& cells) : solid_(cells.solid()) {
  int size = solid_->dofCount(), rigid = 0;
  for (const SceneBody& body : scene.bodies) {
    const Point3 own = body.frame.moved() ? Point3(body.frame.rotation.transpose() * scene.gravity) : scene.gravity;
    gravity_.push_back(own.template head<D>());
    if (!body.hasCells()) {
      given_.emplace_back(solid_->dofCount() + D * rigid, body.given.mass * gravity_.back());
      size = given_.back().first + D;
    }
    rigid += body.rigid ? 1 : 0;
  }
  load_ = Eigen::VectorXd::Zero(size);
  if (scene.gravity.template head<D>().isZero(0)) return;
  const int stencil = solid_->stencil();
  mass_.assign(static_cast<std::size_t>(solid_->cellCount()) * stencil, 0.0);
  for (int c = 0; c < solid_->cellCount(); ++c) {
    const double mass_density = scene.bodies[solid_->cellBody(c)].material.mass_density;
    double* mass = mass_.data() + static_cast<std::size_t>(c) * stencil;
    cells.eachParticle(c, [&](const Vector<D>&, const double* value, double volume) {
      for (int a = 0; a < stencil; ++a) mass[a] += volume * mass_density * value[a];
    });
  }
  update();
}

template <int D>
void Weight<D>::update() {
  if (mass_.empty()) return;
  load_.setZero();
  for (const auto& [first, weight] : given_) load_.template segment<D>(first) = weight;
  const int stencil = solid_->stencil();
  for (int c = 0; c < solid_->cellCount(); ++c) {
    for (int a = 0; a < stencil; ++a) {
      load_.template segment<D>(D * solid_->cellNodes(c)[a]) +=
          solid_->cell(c).density * mass_[static_cast<std::size_t>(c) * stencil + a] * gravity_[solid_->cellBody(c)];
    }
  }
}

template <int D>
void Weight<D>::evaluate(const solver::Point& at, solver::Order order, solver::Sum& sum) const {
  if (mass_.empty()) return;
  sum.energy -= load_.dot(at.y.head(load_.size()));
  if (order == solver::Order::ENERGY) return;
  sum.gradient.head(load_.size()) -= load_;
  sum.noteForce(load_.norm());
}

template <int D>
void Weight<D>::densityDerivative(const solver::Point& at, const Eigen::VectorXd* v, Eigen::VectorXd& by_cell) const {
  if (!mass_.empty()) by_cell -= densitySlope(v != nullptr ? *v : at.y);
}

template <int D>
Eigen::VectorXd Weight<D>::densitySlope(const Eigen::VectorXd& v) const {
  Eigen::VectorXd slope = Eigen::VectorXd::Zero(solid_->cellCount());
  if (mass_.empty()) return slope;
  const int stencil = solid_->stencil();
  for (int c = 0; c < solid_->cellCount(); ++c) {
    for (int a = 0; a < stencil; ++a) {
      slope(c) += mass_[static_cast<std::size_t>(c) * stencil + a] *
                  gravity_[solid_->cellBody(c)].dot(v.template segment<D>(D * solid_->cellNodes(c)[a]));
    }
  }
  return slope;
}

template <int D>
Eigen::VectorXd Constraints<D>::constantLoad() const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(loadSize());
  for (const SceneLoad& load : scene_.loads) {
    if (!load.constant) continue;
    for (const auto& [node, weight] : loadWeights(load)) {
      result.template segment<D>(D * node) += weight / cells_.multiplicity() * load.force.template head<D>();
    }
  }
  return result;
}

template class Weight<2>;
template class Weight<3>;
template Eigen::MatrixXd Constraints<2>::loads() const;
template Eigen::MatrixXd Constraints<3>::loads() const;
template Eigen::VectorXd Constraints<2>::constantLoad() const;
template Eigen::VectorXd Constraints<3>::constantLoad() const;

}  // namespace snapwing::scene
