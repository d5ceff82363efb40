#include "snapwing/solver/point_terms.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "snapwing/common/require.h"

namespace snapwing::solver {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

common::Require requireOf(const std::string& term) { return common::Require("term '" + term + "'"); }

/// What rounding of a point's place leaves of a force of this stiffness [N/m].
void noteRounding(const SpacePoint& point, const Eigen::VectorXd& y, double stiffness, Sum& sum) {
  sum.noteRounding(std::numeric_limits<double>::epsilon() * stiffness * point.matrix().norm() * point.pick(y).norm());
}

/// Adds A^T H A to the only couple of a term.
void addForm(const SpacePoint& point, const Matrix3d& h, Sum& sum) {
  const Eigen::MatrixXd own = point.matrix().transpose() * h * point.matrix();
  int place = sum.couples->front();
  for (Eigen::Index b = 0; b < own.cols(); ++b) {
    for (Eigen::Index a = b; a < own.rows(); ++a) sum.hessian[place++] += own(a, b);
  }
}

}  // namespace

SpacePoint::SpacePoint(const Vector3d& rest, int centre_at, const Rotation& rotation, const Vector3d& centre)
    : rest_(rest), matrix_(Eigen::Matrix3Xd::Zero(3, 12)) {
  const Vector3d arm = (rest - centre) / rotation.length;
  for (int i = 0; i < 3; ++i) {
    coordinates_.push_back(centre_at + i);
    matrix_(i, i) = 1;
  }
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) {
      coordinates_.push_back(rotation.first + i + 3 * j);
      matrix_(i, 3 + i + 3 * j) = arm(j);
    }
  }
}

SpacePoint SpacePoint::between(const SpacePoint& a, const SpacePoint& b) {
  std::map<int, Vector3d> columns;
  for (const auto& [point, sign] : {std::pair{&a, 1.0}, std::pair{&b, -1.0}}) {
    for (std::size_t k = 0; k < point->coordinates_.size(); ++k) {
      Vector3d& column = columns.emplace(point->coordinates_[k], Vector3d::Zero()).first->second;
      column += sign * point->matrix_.col(static_cast<Eigen::Index>(k));
    }
  }
  SpacePoint out;
  out.rest_ = a.rest_ - b.rest_;
  out.matrix_.resize(3, static_cast<Eigen::Index>(columns.size()));
  for (const auto& [coordinate, column] : columns) {
    out.matrix_.col(static_cast<Eigen::Index>(out.coordinates_.size())) = column;
    out.coordinates_.push_back(coordinate);
  }
  return out;
}

SpacePoint SpacePoint::direction(const Vector3d& rest, const Rotation& rotation) {
  SpacePoint out;
  out.rest_ = rest;
  out.matrix_.resize(3, 0);
  for (int j = 0; j < 3; ++j) {
    if (rest(j) == 0) continue;
    const Eigen::Index first = out.matrix_.cols();
    out.matrix_.conservativeResize(3, first + 3);
    out.matrix_.rightCols<3>() = rest(j) / rotation.length * Matrix3d::Identity();
    for (int i = 0; i < 3; ++i) out.coordinates_.push_back(rotation.first + i + 3 * j);
  }
  return out;
}

SpacePoint SpacePoint::inAxes(const Matrix3d& axes) const {
  return {axes.transpose() * rest_, coordinates_, axes.transpose() * matrix_};
}

Eigen::VectorXd SpacePoint::pick(const Eigen::VectorXd& y) const {
  Eigen::VectorXd own(static_cast<Eigen::Index>(coordinates_.size()));
  for (std::size_t k = 0; k < coordinates_.size(); ++k) own(static_cast<Eigen::Index>(k)) = y(coordinates_[k]);
  return own;
}

void SpacePoint::addTo(const Vector3d& force, Eigen::VectorXd& gradient) const {
  const Eigen::VectorXd own = matrix_.transpose() * force;
  for (std::size_t k = 0; k < coordinates_.size(); ++k) gradient(coordinates_[k]) += own(static_cast<Eigen::Index>(k));
}

PointDrag::PointDrag(std::string name, SpacePoint point, double coefficient)
    : name_(std::move(name)), point_(std::move(point)), coefficient_(coefficient) {
  requireOf(name_).notNegative("coefficient", coefficient);
}

void PointDrag::evaluate(const Point& at, Order order, Sum& sum) const {
  if (at.step == nullptr) return;
  const double h = at.step->h;
  const Vector3d v = (point_.displacement(at.y) - point_.displacement(at.step->y0)) / h;
  const double speed = v.norm();
  sum.energy += h * coefficient_ / 3 * speed * speed * speed;
  if (order == Order::ENERGY) return;
  const Vector3d force = coefficient_ * speed * v;
  point_.addTo(force, sum.gradient);
  sum.noteForce(force.norm());
  noteRounding(point_, at.y, 2 * coefficient_ * speed / h, sum);
  if (!elasticity::withTangent(order) || !(speed > 0)) return;
  addForm(point_, coefficient_ / h * (speed * Matrix3d::Identity() + v * v.transpose() / speed), sum);
}

StrutDamper::StrutDamper(std::string name, SpacePoint line, double damping, double behind)
    : name_(std::move(name)), line_(std::move(line)), damping_(damping), behind_(behind) {
  requireOf(name_).notNegative("damping", damping);
}

void StrutDamper::evaluate(const Point& at, Order order, Sum& sum) const {
  if (at.step == nullptr) return;
  const Vector3d before = line_.at(at.step->y0), now = line_.at(at.y);
  if (before.norm() >= behind_) return;
  const double h = at.step->h;
  const Vector3d along = (before + now).normalized();
  const double w = along.dot(now - before) / h;
  sum.energy += 0.5 * h * damping_ * w * w;
  if (order == Order::ENERGY) return;
  line_.addTo(damping_ * w * along, sum.gradient);
  sum.noteForce(damping_ * std::abs(w));
  noteRounding(line_, at.y, damping_ / h, sum);
  if (elasticity::withTangent(order)) sum.addRankOne(0, damping_ / h, line_.matrix().transpose() * along);
}

StrutStop::StrutStop(std::string name, SpacePoint line, double length, double stiffness)
    : name_(std::move(name)), line_(std::move(line)), length_(length), stiffness_(stiffness) {
  requireOf(name_)(length > 0 && std::isfinite(length), "length", length, "> 0 m");
  requireOf(name_)(stiffness > 0 && std::isfinite(stiffness), "stiffness", stiffness, "> 0");
}

void StrutStop::evaluate(const Point& at, Order order, Sum& sum) const {
  const Vector3d line = line_.at(at.y);
  const double now = line.norm(), into = length_ - now;
  if (into <= 0) return;
  const double energy = 0.5 * stiffness_ * into * into;
  sum.energy += energy;
  sum.stored += energy;
  if (order == Order::ENERGY) return;
  const Vector3d along = line / now;
  line_.addTo(-stiffness_ * into * along, sum.gradient);
  sum.noteForce(stiffness_ * into);
  noteRounding(line_, at.y, stiffness_, sum);
  if (!elasticity::withTangent(order)) return;
  Matrix3d h = stiffness_ * along * along.transpose();
  if (order == Order::TANGENT) h -= stiffness_ * into / now * (Matrix3d::Identity() - along * along.transpose());
  addForm(line_, h, sum);
}

Propeller::Propeller(std::string name, SpacePoint hub, const Rotation& rotation, const Data& data)
    : name_(std::move(name)), hub_(std::move(hub)), rotation_(rotation), data_(data) {
  const common::Require require = requireOf(name_);
  require(std::abs(data.axis.norm() - 1) < 1e-12, "axis", data.axis.norm(), "length 1");
  require(data.full_thrust > 0 && std::isfinite(data.full_thrust), "full_thrust", data.full_thrust, "> 0 N");
  require.notNegative("no_thrust_speed", data.no_thrust_speed, " m/s");
  require(std::isfinite(data.moment), "moment", data.moment, "finite");
}

Propeller::Held Propeller::heldAt(const Point& at) const {
  const Step* step = at.step;
  Matrix3d turned = Matrix3d::Identity();
  for (int k = 0; k < 9; ++k) {
    const int place = rotation_.first + k;
    turned(k) += (step != nullptr ? step->y0(place) + 0.5 * step->h * step->v0(place) : at.y(place)) / rotation_.length;
  }
  const Vector3d axis = (turned * data_.axis).normalized();
  return {axis, skewOf(data_.moment * axis) * turned / (2 * rotation_.length)};
}

double Propeller::perThrust(const Held& held, const Eigen::VectorXd& y) const {
  double work = held.axis.dot(hub_.displacement(y));
  for (int k = 0; k < 9; ++k) work += held.couple(k) * y(rotation_.first + k);
  return work;
}

void Propeller::addUnit(const Held& held, double times, Eigen::VectorXd& gradient) const {
  hub_.addTo(times * held.axis, gradient);
  for (int k = 0; k < 9; ++k) gradient(rotation_.first + k) += times * held.couple(k);
}

void Propeller::evaluate(const Point& at, Order order, Sum& sum) const {
  const Step* step = at.step;
  const Held held = heldAt(at);
  const double thrust = at.p(data_.control), per_thrust = perThrust(held, at.y);
  sum.energy -= thrust * per_thrust;
  double slope = 0, w = 0;  // [N s/m] by which thrust falls; [m/s]
  if (step != nullptr && data_.no_thrust_speed > 0) {
    slope = std::sqrt(std::max(0.0, thrust) * data_.full_thrust) / data_.no_thrust_speed;
    w = held.axis.dot(hub_.displacement(at.y) - hub_.displacement(step->y0)) / step->h;
    sum.energy += 0.5 * step->h * slope * w * w;
  }
  if (order == Order::ENERGY) return;
  addUnit(held, -thrust, sum.gradient);
  hub_.addTo(slope * w * held.axis, sum.gradient);
  sum.control(data_.control) -= per_thrust;
  sum.noteForce(std::abs(thrust));
  if (elasticity::withTangent(order) && slope > 0) {
    sum.addRankOne(0, slope / step->h, hub_.matrix().transpose() * held.axis);
  }
}

void Propeller::controlTangent(const Point& at, const Eigen::VectorXd& dy, const Eigen::VectorXd& dp,
                               Eigen::VectorXd& by_y, Eigen::VectorXd& by_p) const {
  const Held held = heldAt(at);
  addUnit(held, -dp(data_.control), by_y);
  by_p(data_.control) -= perThrust(held, dy);
}

}  // namespace snapwing::solver
