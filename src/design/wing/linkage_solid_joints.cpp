#include "linkage_solid_joints.h"

#include <Eigen/Geometry>
#include <cmath>

namespace snapwing::design {

using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

namespace {

constexpr double WELD_LENGTH = 0.01;  ///< [m] scales the weld's strains to the size of the other rows
constexpr Complex I{0, 1};

/// Levels through the thickness at which a segment is held: two keep it straight and upright.
template <int D>
std::vector<double> levels() {
  if (D == 2) return {0.5};
  return {0.2, 0.8};
}

}  // namespace

template <int D>
SolidJoints<D>::SolidJoints(const FourBar& layout, const WingBars& bars, const SolidSettings& s,
                            const SolidMesh<D>& mesh)
    : layout_(layout), bars_(bars), settings_(s), mesh_(mesh) {
  ground("driven port", ARM_BAR, -s.driver);
  ground("axle", ARM_BAR, 0);
  join("joint X1", ARM_BAR, 1, COUPLER_BAR, 0);
  join("joint X2", COUPLER_BAR, 1, ROCKER_BAR, 1);
  ground("auxiliary joint", ROCKER_BAR, 0);
  join("weld of the wing", COUPLER_BAR, 1, EDGE_BAR, 0);
  weld();
  for (std::size_t i = 0; i < s.ground_pins.size(); ++i) {
    const GroundPin& pin = s.ground_pins[i];
    const int bar = pin.body == 0 ? ARM_BAR : pin.body == 2 ? ROCKER_BAR : COUPLER_BAR + pin.bar;
    ground("ground pin " + std::to_string(i), bar, pin.fraction);
  }
  H_.resize(static_cast<Eigen::Index>(names_.size()), mesh.solid()->dofCount());
  H_.setFromTriplets(entries_.begin(), entries_.end());
}

template <int D>
int SolidJoints<D>::newRow(const std::string& name) {
  names_.push_back(name);
  return static_cast<int>(names_.size()) - 1;
}

template <int D>
void SolidJoints<D>::addRow(const NodeWeights& weights, int axis, double sign, int row) {
  for (const auto& [node, weight] : weights) entries_.emplace_back(row, D * node + axis, sign * weight);
}

/// Equal displacement of two points, or none of one (second < 0); in three dimensions of a segment.
template <int D>
void SolidJoints<D>::join(const std::string& name, int first, double t_first, int second, double t_second) {
  const auto add = [&](double level, int axis) {
    const int row = newRow(name);
    addRow(mesh_.at(first, t_first, level), axis, 1, row);
    if (second >= 0) addRow(mesh_.at(second, t_second, level), axis, -1, row);
  };
  for (const double level : levels<D>()) {
    for (int axis = 0; axis < 2; ++axis) add(level, axis);
  }
  if (D == 3) add(0.5, 2);
}

/// l (Du_coupler / d_coupler - Du_edge / d_edge) = 0. Division by d is a linear map: 1 / d = conj(d) / |d|^2.
template <int D>
void SolidJoints<D>::weld() {
  weld_row_ = newRow("weld of the wing, turn");
  newRow("weld of the wing, turn");
  const auto add = [&](int bar, double t, double sign) {
    const Complex inverse = sign * WELD_LENGTH / mesh_.bar(bar).piece(2 * settings_.grip);
    const NodeWeights difference = mesh_.difference(bar, t, settings_.grip);
    addRow(difference, 0, inverse.real(), weld_row_);
    addRow(difference, 1, -inverse.imag(), weld_row_);
    addRow(difference, 0, inverse.imag(), weld_row_ + 1);
    addRow(difference, 1, inverse.real(), weld_row_ + 1);
  };
  add(COUPLER_BAR, 1, 1);
  add(EDGE_BAR, 0, -1);
}

template <int D>
VectorXd SolidJoints<D>::driven(double theta) const {
  VectorXd h = VectorXd::Zero(H_.rows());
  const Vector2d port = -settings_.driver * layout_.joint1;
  const Vector2d moved = Eigen::Rotation2Dd(layout_.crank_sign * theta) * port - port;
  for (std::size_t k = 0; k < levels<D>().size(); ++k) h.segment<2>(2 * static_cast<Eigen::Index>(k)) = moved;
  return h;
}

template <int D>
std::vector<typename SolidJoints<D>::Couple> SolidJoints<D>::couples(double theta) const {
  const PinMoments M = frictionAt(layout_, bars_, theta);
  const auto pose = sensitivityAt(layout_, theta);
  if (!pose || bars_.friction_moment == 0) return {};
  const double arm = layout_.crank_sign * theta, wing = pose->pose.wing_rotation, rocker = pose->pose.rocker_rotation;
  const Eigen::RowVector4d none = Eigen::RowVector4d::Zero();
  return {{ARM_BAR, 0, M.axle, arm, none},
          {ARM_BAR, 1, -M.joint1, arm, none},
          {COUPLER_BAR, 0, M.joint1, wing, pose->wing_rotation},
          {COUPLER_BAR, 1, M.joint2, wing, pose->wing_rotation},
          {ROCKER_BAR, 1, -M.joint2, rocker, pose->rocker_rotation},
          {ROCKER_BAR, 0, M.auxiliary, rocker, pose->rocker_rotation}};
}

template <int D>
Complex SolidJoints<D>::forceOf(const Couple& c) const {
  return c.moment * I * std::exp(I * c.phi) / std::conj(mesh_.bar(c.bar).piece(2 * settings_.grip));
}

template <int D>
VectorXd SolidJoints<D>::friction(double theta) const {
  VectorXd f = VectorXd::Zero(H_.cols());
  for (const Couple& c : couples(theta)) {
    scatter<D>(mesh_.difference(c.bar, c.t, settings_.grip), vectorOf(forceOf(c)), f);
  }
  return f;
}

template <int D>
MatrixXd SolidJoints<D>::rowsByX(double theta, const VectorXd& u) const {
  MatrixXd by_X = MatrixXd::Zero(H_.rows(), 4);
  const Matrix2d turn = Eigen::Rotation2Dd(layout_.crank_sign * theta).toRotationMatrix() - Matrix2d::Identity();
  for (std::size_t k = 0; k < levels<D>().size(); ++k) {
    by_X.block<2, 2>(2 * static_cast<Eigen::Index>(k), 0) = settings_.driver * turn;  // -dh, h = -driver turn X1
  }
  const auto add = [&](int bar, double t, double sign) {
    const Complex d = mesh_.bar(bar).piece(2 * settings_.grip);
    const ComplexSlopes slopes = mesh_.bar(bar).pieceSlopes(2 * settings_.grip);
    const Complex moved = complexOf(gathered<D>(mesh_.difference(bar, t, settings_.grip), u));
    for (int k = 0; k < 4; ++k) {
      by_X.block<2, 1>(weld_row_, k) += vectorOf(-sign * WELD_LENGTH * moved * slopes[k] / (d * d));
    }
  };
  add(COUPLER_BAR, 1, 1);
  add(EDGE_BAR, 0, -1);
  return by_X;
}

template <int D>
MatrixXd SolidJoints<D>::forcesByX(double theta, const VectorXd& lambda) const {
  MatrixXd by_X = MatrixXd::Zero(H_.cols(), 4);
  const auto add = [&](int bar, double t, const Complex& slope, int k) {
    scatter<D>(mesh_.difference(bar, t, settings_.grip), vectorOf(slope), by_X.col(k));
  };
  // Force of the weld on Du: lambda l / conj(d).
  const Complex pull = WELD_LENGTH * complexOf(lambda.segment<2>(weld_row_));
  const auto addWeld = [&](int bar, double t, double sign) {
    const Complex d = std::conj(mesh_.bar(bar).piece(2 * settings_.grip));
    const ComplexSlopes slopes = mesh_.bar(bar).pieceSlopes(2 * settings_.grip);
    for (int k = 0; k < 4; ++k) add(bar, t, -sign * pull * std::conj(slopes[k]) / (d * d), k);
  };
  addWeld(COUPLER_BAR, 1, 1);
  addWeld(EDGE_BAR, 0, -1);
  for (const Couple& c : couples(theta)) {
    const Complex d = std::conj(mesh_.bar(c.bar).piece(2 * settings_.grip)), force = forceOf(c);
    const ComplexSlopes slopes = mesh_.bar(c.bar).pieceSlopes(2 * settings_.grip);
    for (int k = 0; k < 4; ++k) add(c.bar, c.t, -force * (I * c.dphi[k] - std::conj(slopes[k]) / d), k);
  }
  return by_X;
}

template class SolidJoints<2>;
template class SolidJoints<3>;

}  // namespace snapwing::design
