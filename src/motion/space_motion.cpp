// What a vehicle in space does: its momenta, what a record says of it, and in words what it is.
#include <algorithm>
#include <cmath>

#include "arm_bodies.h"
#include "snapwing/common/plain_text.h"
#include "snapwing/motion/space_vehicle.h"

namespace snapwing::motion {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector3d SpaceVehicle::inWorld(const Arrow& arrow, const Eigen::VectorXd& full) const {
  const Vector3d own = full.segment<3>(arrow.first);
  return arrow.arm < 0 ? own : Vector3d(turned_[arrow.arm] * own);
}

Eigen::VectorXd SpaceVehicle::rigidRates(const Eigen::VectorXd& y, const Vector3d& velocity,
                                         const Vector3d& turn) const {
  Eigen::VectorXd v(y.size());
  for (const Arrow& arrow : arrows_) {
    Vector3d rate = turn.cross(arrow.rest + inWorld(arrow, y));
    if (arrow.moves) rate += velocity;
    if (arrow.arm >= 0) rate = turned_[arrow.arm].transpose() * rate;
    v.segment<3>(arrow.first) = rate;
  }
  if (trial_.mount == vehicle::Mount::HELD) return v;
  if (boom_ > 0) v.segment<3>(ring_.centre_at).setZero();
  return v;
}

Vector3d SpaceVehicle::linearMomentum(const Stepper& stepper, const MotionState& s) const {
  const Eigen::VectorXd p = stepper.momentum(s.v);
  Vector3d sum = Vector3d::Zero();
  for (const Arrow& arrow : arrows_) {
    if (arrow.moves) sum += inWorld(arrow, p);
  }
  return sum;
}

Vector3d SpaceVehicle::angularMomentum(const Stepper& stepper, const MotionState& s) const {
  const Eigen::VectorXd p = stepper.momentum(s.v);
  Vector3d sum = Vector3d::Zero();
  for (const Arrow& arrow : arrows_) sum += (arrow.rest + inWorld(arrow, s.y)).cross(inWorld(arrow, p));
  return sum;
}

RigidMotions SpaceVehicle::rigidMotions() const {
  if (trial_.mount == vehicle::Mount::HELD) return {};
  return [this](const Eigen::VectorXd& y) {
    if (boom_ > 0) {
      const Vector3d turn = Vector3d::UnitZ();
      return Eigen::MatrixXd(rigidRates(y, -turn.cross(ring_.centre), turn));
    }
    Eigen::MatrixXd motions(y.size(), 6);
    for (int k = 0; k < 3; ++k) {
      motions.col(k) = rigidRates(y, Vector3d::Unit(k), Vector3d::Zero());
      motions.col(3 + k) = rigidRates(y, Vector3d::Zero(), Vector3d::Unit(k));
    }
    return motions;
  };
}

double SpaceVehicle::commonSpeed(const MotionState& s, const Stepper& stepper) const {
  return linearMomentum(stepper, s).dot(orientation(ring_, s.y).col(1)) / mass_;
}

Matrix3d SpaceVehicle::orientation(const RigidBody& body, const Eigen::VectorXd& y) const {
  Matrix3d r = Matrix3d::Identity();
  for (int k = 0; k < 9; ++k) r(k) += y(body.rotation.first + k) / body.rotation.length;
  return r;
}

Vector3d SpaceVehicle::ringTurning(const MotionState& s) const {
  Matrix3d rate;
  for (int k = 0; k < 9; ++k) rate(k) = s.v(ring_.rotation.first + k) / ring_.rotation.length;
  const Matrix3d w = rate * orientation(ring_, s.y).transpose();
  return 0.5 * Vector3d(w(2, 1) - w(1, 2), w(0, 2) - w(2, 0), w(1, 0) - w(0, 1));
}

/// Displacements of the nodes as the ring sees them, in the axes of their arms.
Eigen::VectorXd SpaceVehicle::inRingFrame(const Eigen::VectorXd& y) const {
  const Matrix3d back = orientation(ring_, y).transpose();
  const Vector3d moved = ring_.centre + y.segment<3>(ring_.centre_at);
  Eigen::VectorXd u(nodes_);
  for (const Arrow& arrow : arrows_) {
    if (arrow.first >= nodes_) continue;  // of bodies
    const Vector3d seen = back * (arrow.rest + inWorld(arrow, y) - moved) + ring_.centre - arrow.rest;
    u.segment<3>(arrow.first) = turned_[arrow.arm].transpose() * seen;
  }
  return u;
}

AxisSample SpaceVehicle::sample(const MotionState& s) const {
  AxisSample out;
  out.time = s.time;
  const Matrix3d ring = orientation(ring_, s.y), housing = orientation(housing_, s.y);
  const Vector3d place = hub_.displacement(s.y), velocity = hub_.displacement(s.v), axis = ring.col(1).normalized();
  const Vector3d line = strut_.at(s.y);
  const auto angle = [](double cosine) { return std::acos(std::clamp(cosine, -1.0, 1.0)); };
  out.ring_speed = velocity.dot(axis);
  out.ring_position = place(1);
  if (boom_ > 0) out.ring_position = boom_ * std::atan2(ring(1, 0), ring(0, 0));
  out.travel = line.norm() - strut_.at(Eigen::VectorXd::Zero(s.y.size())).norm();
  out.travel_rate = line.normalized().dot(strut_.displacement(s.v));
  out.centre_speed = out.ring_speed - out.travel_rate;
  out.arm_rotation = scene_->monitor(0, inRingFrame(s.y));
  out.tilt = angle(axis(1));
  out.housing_tilt = angle(0.5 * ((ring.transpose() * housing).trace() - 1));
  out.drift = std::hypot(place(0), place(2));
  out.turn_rate = ringTurning(s).norm();
  const Vector3d from_hub = pointOf(housing_, housing_.centre).at(s.y) - hub_.at(s.y);
  out.centre_off = (from_hub - axis.dot(from_hub) * axis).norm();
  if (linkage_) {
    const Eigen::VectorXd seen = inRingFrame(s.y);
    out.wing_left = wingAngle(s, 0, seen), out.wing_right = wingAngle(s, 1, seen);
    out.hub_twist = 0;
    for (const auto& hub : hubs_) out.hub_twist = std::max(out.hub_twist, std::abs(hub->twist(s.y)));
  }
  out.kinetic = s.kinetic, out.stored = s.stored;
  strain_->record(s.y.head(nodes_), out);
  return out;
}

double SpaceVehicle::wingAngle(const MotionState& s, int wing, const Eigen::VectorXd& in_ring_frame) const {
  return wings_.wingAngle(s.y, wing, linkage_->guessAt(scene_->monitor(armOfWing(wing), in_ring_frame)).wing);
}

std::string SpaceVehicle::vtu(const MotionState& s) const { return scene_->vtuOf(s.y.head(nodes_)); }

std::vector<std::string> SpaceVehicle::kept() const {
  std::vector<std::string> out{
      "ring and housing as rigid bodies with all their motions, every arm as a separate solid that deforms in space",
      "thrust of each propeller at its position, along the ring's own axis, with the common rotor lag",
      "drag of ring and centre against their velocity in space"};
  const std::string loaded = linkage_ ? "centre, arms and wings" : "centre and arms";
  if (onBoom()) out.push_back("rotation of the boom about its axis, with the centripetal load on " + loaded);
  if (linkage_) {
    out.push_back(onBoom()
                      ? "wings as rigid bars with pins on the soft arms, in the plane of the boom's rotation: left "
                        "outside, right inside"
                      : "wings as rigid bars with pins on ring and soft arms, which turn in space with the ring");
  }
  if (space_.moment_per_thrust > 0) out.push_back("yaw moment of the propellers");
  if (space_.no_thrust_speed > 0) out.push_back("thrust that falls with the speed along the axis");
  if (space_.sag > 0) out.push_back("battery sag with the total thrust");
  return out;
}

std::vector<std::string> SpaceVehicle::leftOut() const {
  std::vector<std::string> out{
      "a flight controller: the rotors' thrust is prescribed, and nothing stabilises the attitude",
      "aerodynamic moments, aerodynamic forces on the arms, gyroscopic moments of rotors and propellers",
      "the ring's actual shape: its mass is that of a thin ring; the housing is a solid cylinder",
      "friction of the arms' axles beyond the damping ratio, and sliding of an arm along its axle"};
  if (linkage_) {
    for (const std::string& what : wings_.leftOut(wing_forces_)) out.push_back(what);
    if (trial_.gravity != 0 || space_.gravity_across != 0 || trial_.initial_thrust_fraction.value_or(0) > 0 ||
        wing_forces_.fold_bias > 0) {
      out.push_back("the wings' load in the equilibrium at the start");
    }
    if (trial_.mount != vehicle::Mount::FREE) {
      out.push_back("rotation of the wings about other axes than those of their pins at rest");
    }
  } else {
    out.push_back("wings and their linkage");
  }
  if (trial_.initial_thrust_fraction.value_or(0) > 0) {
    out.push_back("differences between the rotors in the equilibrium at the start");
  }
  if (!(space_.moment_per_thrust > 0)) out.push_back("yaw moment of the propellers (propellers: moment_per_thrust)");
  if (!(space_.no_thrust_speed > 0)) out.push_back("thrust that falls with airspeed (propellers: no_thrust_speed)");
  if (!(space_.sag > 0)) out.push_back("battery sag (propellers: sag)");
  if (axis_.series().empty()) out.push_back("memory of the material: a slow curve, a snap and a rest have one modulus");
  return out;
}

}  // namespace snapwing::motion
