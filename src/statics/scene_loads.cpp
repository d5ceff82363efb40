// Loads of a scene: tractions that grow with the control, constant ones, weight.
#include <algorithm>
#include <cmath>

#include "scene_constraints.h"
#include "snapwing/common/error.h"

namespace snapwing::statics {

using mpm::Vector;

/// Share of each node in a uniform traction, by samples on the part of the face that bounds material.
template <int D>
Eigen::VectorXd Constraints<D>::faceWeights(const SceneLoad& load) const {
  const int axis = flatAxis<D>(load.region);
  if (axis < 0) throw common::Error("'" + load.name + "': the region of a load must be flat along one axis");
  const mpm::Grid<D>& grid = solid_.grid(load.body);
  const int n = 4;
  const int samples = D == 2 ? n : n * n;
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(solid_.nodeCount()), value;
  Eigen::Matrix<double, D, Eigen::Dynamic> slope;
  double total = 0;
  for (int c = 0; c < solid_.cellCount(); ++c) {
    if (solid_.cellBody(c) != load.body) continue;
    const Vector<D> low = grid.cellCentre(solid_.cellAt(c)) - Vector<D>::Constant(0.5 * grid.cell_size);
    const double along = (load.region.low(axis) - low(axis)) / grid.cell_size;
    const bool last = solid_.cellAt(c)[axis] == grid.cells[axis] - 1;
    if (along < -1e-6 || along > 1 + (last ? 1e-6 : -1e-6)) continue;
    for (int s = 0; s < samples; ++s) {
      Vector<D> local;
      for (int a = 0, rest = s; a < D; ++a) {
        if (a == axis) continue;
        local(a) = (rest % n + 0.5) / n;
        rest /= n;
      }
      local(axis) = std::min(std::max(along, 0.0), 1.0);
      Vector<D> x = low + grid.cell_size * local;
      Point3 p = Point3::Zero();
      p.head<D>() = x;
      if (!load.region.contains(p, 1e-6 * grid.cell_size)) continue;
      x(axis) += (last ? -1e-6 : 1e-6) * grid.cell_size;  // just inside
      if (!cells_.contains(load.body, x)) continue;
      grid.weights(local, value, slope);
      for (int a = 0; a < solid_.stencil(); ++a) weights(solid_.cellNodes(c)[a]) += value(a);
      total += 1;
    }
  }
  if (!(total > 0))
    throw common::Error("'" + load.name + "' meets no material of body '" + scene_.bodies[load.body].name + "'");
  return weights / total;
}

template <int D>
Eigen::MatrixXd Constraints<D>::loads() const {
  Eigen::MatrixXd result;
  for (const SceneLoad& load : scene_.loads) {
    if (load.constant) continue;
    if (result.size() == 0) result = Eigen::MatrixXd::Zero(solid_.dofCount(), 1);
    const Eigen::VectorXd weights = faceWeights(load);
    for (int a = 0; a < D; ++a) {
      for (int node = 0; node < solid_.nodeCount(); ++node) result(D * node + a, 0) += weights(node) * load.force(a);
    }
  }
  return result / cells_.multiplicity();
}

template <int D>
void Constraints<D>::addGravity(Eigen::VectorXd& force) const {
  for (int c = 0; c < solid_.cellCount(); ++c) {
    const double mass_density = scene_.bodies[solid_.cellBody(c)].material.mass_density * solid_.cell(c).density;
    cells_.eachParticle(c, [&](const Vector<D>&, const double* value, double w) {
      for (int a = 0; a < solid_.stencil(); ++a) {
        force.template segment<D>(D * solid_.cellNodes(c)[a]) +=
            w * mass_density * value[a] * scene_.gravity.template head<D>();
      }
    });
  }
}

template <int D>
Eigen::VectorXd Constraints<D>::deadLoad() const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(solid_.dofCount());
  for (const SceneLoad& load : scene_.loads) {
    if (!load.constant) continue;
    const Eigen::VectorXd weights = faceWeights(load) / cells_.multiplicity();
    for (int node = 0; node < solid_.nodeCount(); ++node) {
      result.template segment<D>(D * node) += weights(node) * load.force.template head<D>();
    }
  }
  addGravity(result);
  if (result.isZero(0)) return {};
  return result;
}

template Eigen::MatrixXd Constraints<2>::loads() const;
template Eigen::MatrixXd Constraints<3>::loads() const;
template Eigen::VectorXd Constraints<2>::deadLoad() const;
template Eigen::VectorXd Constraints<3>::deadLoad() const;

}  // namespace snapwing::statics
