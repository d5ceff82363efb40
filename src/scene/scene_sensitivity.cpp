#include <cmath>

#include "scene_constraints.h"
#include "scene_sensitivity_of.h"
#include "snapwing/common/error.h"
#include "snapwing/mpm/cell_values.h"

namespace snapwing::scene {

template <int D>
SceneSensitivityOf<D>::SceneSensitivityOf(SensitivityParts<D> parts, const solver::Equilibrium& x)
    : parts_(std::move(parts)),
      x_(x),
      cholesky_(parts_.problem.pattern()),
      system_(parts_.problem, cholesky_),
      adjoint_(parts_.problem, system_, x_.at, parts_.solid.cellCount()) {
  if (system_.factorize(x_.at) < 0) {
    throw common::Error("sensitivities do not exist at control " + std::to_string(x_.p(0)) +
                        ": the Hessian is singular there (a limit point, a bifurcation or a free motion)");
  }
  tangent_ = adjoint_.tangent();
  const solver::Constraints* constraints = parts_.problem.constraints();
  if (constraints == nullptr) return;
  force_ = x_.multipliers + constraints->penalty() * x_.at.constraint_residual;
  moveJoints();
}

template <int D>
void SceneSensitivityOf<D>::moveJoints() {
  for (int joint = 0; joint < static_cast<int>(parts_.scene.joints.size()); ++joint) {
    if (parts_.scene.joints[joint].kind == JointKind::FACE) continue;
    joints_.push_back(joint);
    for (const int axis : {0, 1}) rows_.push_back(movedRows(joint, axis));
  }
}

template <int D>
solver::LinearRows SceneSensitivityOf<D>::movedRows(int joint, int axis) const {
  constexpr double SHARE = 1e-3;  // of a cell
  const double step = SHARE * parts_.scene.cell_size;
  solver::LinearRows at[2];
  for (const int side : {0, 1}) {
    Scene moved = parts_.scene;
    SceneJoint& place = moved.joints[joint];
    const double by = side == 0 ? -step : step;
    (axis == 0 ? place.x : place.y) += by;
    place.from(axis) += by;
    place.to(axis) += by;
    const SceneCells<D> cells(moved, parts_.mirror);
    const Constraints<D> constraints(moved, cells);
    at[side] = constraints.split(constraints.equations()).kept;
    if (at[side].equation != parts_.problem.constraints()->linear().equation) {
      throw common::Error("joint '" + place.name + "' lies within " + std::to_string(step) +
                          " m of the edge of a body or of another constraint: it has no derivative by its place");
    }
  }
  at[1].rows = solver::ConstraintRows((at[1].rows - at[0].rows) / (2 * step));
  at[1].control = (at[1].control - at[0].control) / (2 * step);
  at[1].constant = (at[1].constant - at[0].constant) / (2 * step);
  return at[1];
}

template <int D>
SceneSlope SceneSensitivityOf<D>::reaction() const {
  SceneSlope result;
  result.density = adjoint_.reaction(tangent_);
  result.joint.resize(joints_.size(), 2);
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    result.joint(k / 2, k % 2) = tangent_.multipliers.dot(rows_[k].residual(x_.at.place.y, x_.p)) +
                                 force_.dot(rows_[k].rows * tangent_.y - rows_[k].control.col(0));
  }
  return result;
}

template <int D>
SceneSlope SceneSensitivityOf<D>::potential() const {
  SceneSlope result;
  result.density = adjoint_.potential();
  result.joint.resize(joints_.size(), 2);
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    result.joint(k / 2, k % 2) = force_.dot(rows_[k].residual(x_.at.place.y, x_.p));
  }
  return result;
}

template <int D>
SceneSlope SceneSensitivityOf<D>::functional(const Eigen::VectorXd& gradient) const {
  const solver::Variation w = adjoint_.adjoint(gradient);
  SceneSlope result;
  result.density = adjoint_.displacement(w);
  result.joint.resize(joints_.size(), 2);
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    result.joint(k / 2, k % 2) =
        force_.dot(rows_[k].rows * w.y) + w.multipliers.dot(rows_[k].residual(x_.at.place.y, x_.p));
  }
  return result;
}

template <int D>
SceneSlope SceneSensitivityOf<D>::compliance() const {
  Eigen::VectorXd load = parts_.weight.load();
  if (const Eigen::VectorXd dead = parts_.loads.loadAt(x_.p); dead.size() > 0) load += dead;
  SceneSlope result = functional(load);
  // The weight is part of the functional itself.
  Eigen::VectorXd own = Eigen::VectorXd::Zero(parts_.solid.cellCount());
  parts_.weight.densityDerivative({x_.at.place.y, x_.p, nullptr, 1}, nullptr, own);
  result.density -= own;
  return result;
}

template <int D>
SceneSlope SceneSensitivityOf<D>::monitor(int number) const {
  return functional(parts_.monitors.col(number));
}

template <int D>
SceneSlope SceneSensitivityOf<D>::volume() const {
  SceneSlope result;
  result.density = mpm::cellVolumes(parts_.solid);
  result.joint = Eigen::MatrixXd::Zero(joints_.size(), 2);
  return result;
}

template class SceneSensitivityOf<2>;
template class SceneSensitivityOf<3>;

}  // namespace snapwing::scene
