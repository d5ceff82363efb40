#pragma once
/// Terms of material points of rigid bodies in space: drag of a point, dampers and stops between two points,
/// propellers. A damper's force acts along the line between its points at the middle of the step, so that it does not
/// change the angular momentum of a step that conserves it.

#include <Eigen/Core>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "snapwing/solver/rotation.h"
#include "snapwing/solver/term.h"

namespace snapwing::solver {

/// A vector that is affine in the full coordinates, x = rest + A y [m]: the position of a point, or the vector between
/// two points. World axes.
class SpacePoint {
 public:
  SpacePoint() = default;
  /// Point of a rigid body: x = rest + c + E (rest - centre) / L.
  /// @param rest  position at rest [m]; @param centre_at  full coordinate of the first component of c
  /// @param centre  the point at rest whose displacement is c [m]
  SpacePoint(const Eigen::Vector3d& rest, int centre_at, const Rotation& rotation, const Eigen::Vector3d& centre);
  /// a - b: the vector from b to a.
  static SpacePoint between(const SpacePoint& a, const SpacePoint& b);
  /// @param rest  x at y = 0 [m]; @param coordinates  none twice; @param matrix  A, a column for each coordinate
  SpacePoint(const Eigen::Vector3d& rest, std::vector<int> coordinates, Eigen::Matrix3Xd matrix)
      : rest_(rest), coordinates_(std::move(coordinates)), matrix_(std::move(matrix)) {}
  /// A unit direction that is fixed in a body. @param rest  at rest; @param rotation  of the body
  static SpacePoint direction(const Eigen::Vector3d& rest, const Rotation& rotation);
  /// The same vector in other axes. @param axes  orthonormal columns
  SpacePoint inAxes(const Eigen::Matrix3d& axes) const;

  Eigen::Vector3d at(const Eigen::VectorXd& y) const { return rest_ + displacement(y); }      ///< [m]
  Eigen::Vector3d displacement(const Eigen::VectorXd& y) const { return matrix_ * pick(y); }  ///< A y [m]
  const Eigen::Vector3d& rest() const { return rest_; }                                       ///< x at y = 0 [m]
  const std::vector<int>& coordinates() const { return coordinates_; }
  const Eigen::Matrix3Xd& matrix() const { return matrix_; }  ///< columns of A for coordinates() [1]
  /// gradient += A^T force. [N]
  void addTo(const Eigen::Vector3d& force, Eigen::VectorXd& gradient) const;
  /// The coordinates() of y.
  Eigen::VectorXd pick(const Eigen::VectorXd& y) const;

 private:
  Eigen::Vector3d rest_ = Eigen::Vector3d::Zero();
  std::vector<int> coordinates_;
  Eigen::Matrix3Xd matrix_;
};

/// Drag force k |v| v of a point, v the step's mean velocity: h k/3 |v|^3. Zero in statics.
class PointDrag : public Term {
 public:
  /// @param coefficient  k = rho CdA / 2 [N s2/m2] >= 0. @throws common::Error
  PointDrag(std::string name, SpacePoint point, double coefficient);
  std::string name() const override { return name_; }
  Role role() const override { return Role::DISSIPATION; }
  std::vector<std::vector<int>> couples() const override { return {point_.coordinates()}; }
  void evaluate(const Point& at, Order order, Sum& sum) const override;

 private:
  std::string name_;
  SpacePoint point_;
  double coefficient_;
};

/// Damper between two points: h c/2 w^2, w the step's change of the line between them along the mean of its directions
/// at start and end, over h. The Hessian treats this direction as constant. Zero in statics.
class StrutDamper : public Term {
 public:
  /// @param line  SpacePoint::between the points; @param damping  c [N s/m] >= 0
  /// @param behind  the damper acts in steps that begin with a line shorter than this [m]. @throws common::Error
  StrutDamper(std::string name, SpacePoint line, double damping,
              double behind = std::numeric_limits<double>::infinity());
  std::string name() const override { return name_; }
  Role role() const override { return Role::DISSIPATION; }
  std::vector<std::vector<int>> couples() const override { return {line_.coordinates()}; }
  void evaluate(const Point& at, Order order, Sum& sum) const override;

 private:
  std::string name_;
  SpacePoint line_;
  double damping_, behind_;
};

/// Unilateral stop on the distance l of two points: k/2 (length - l)^2 where l < length, else 0.
class StrutStop : public Term {
 public:
  /// @param line  SpacePoint::between the points
  /// @param length  [m] > 0; @param stiffness  k [N/m] > 0. @throws common::Error
  StrutStop(std::string name, SpacePoint line, double length, double stiffness);
  std::string name() const override { return name_; }
  Role role() const override { return Role::STORED; }
  std::vector<std::vector<int>> couples() const override { return {line_.coordinates()}; }
  void evaluate(const Point& at, Order order, Sum& sum) const override;

 private:
  std::string name_;
  SpacePoint line_;
  double length_, stiffness_;
};

/// Propeller on a rigid body: thrust T along an axis fixed in the body (a follower force), and a yaw moment k T about
/// it. The thrust decreases with the speed v of the hub along the axis, T - sqrt(T T_full) v / v_none, as for blades of
/// fixed pitch. The axis is extrapolated to the middle of the step with the rates at its start, and is constant during
/// the step.
class Propeller : public Term {
 public:
  struct Data {
    Eigen::Vector3d axis = Eigen::Vector3d::UnitY();  ///< of the thrust at rest in world axes, unit vector
    int control = 0;                                  ///< number of the control T [N]
    double moment = 0;                                ///< k [m]: moment on the body about the axis per thrust, signed
    double full_thrust = 1;                           ///< T_full [N] > 0
    double no_thrust_speed = 0;                       ///< v_none, at which T_full is lost [m/s]; 0: constant thrust
  };
  /// @param hub  point of the body; @param rotation  of the same body. @throws common::Error
  Propeller(std::string name, SpacePoint hub, const Rotation& rotation, const Data& data);
  std::string name() const override { return name_; }
  Role role() const override { return Role::LOAD; }
  std::vector<std::vector<int>> couples() const override { return {hub_.coordinates()}; }
  void evaluate(const Point& at, Order order, Sum& sum) const override;
  /// Of the thrust T; the decrease with speed is treated as constant.
  void controlTangent(const Point& at, const Eigen::VectorXd& dy, const Eigen::VectorXd& dp, Eigen::VectorXd& by_y,
                      Eigen::VectorXd& by_p) const override;

 private:
  struct Held {
    Eigen::Vector3d axis;    ///< in the world
    Eigen::Matrix3d couple;  ///< generalised force of the yaw moment on the entries of E, per unit of thrust [1]
  };
  Held heldAt(const Point& at) const;
  /// Work per unit of thrust [m].
  double perThrust(const Held& held, const Eigen::VectorXd& y) const;
  void addUnit(const Held& held, double times, Eigen::VectorXd& gradient) const;

  std::string name_;
  SpacePoint hub_;
  Rotation rotation_;
  Data data_;
};

}  // namespace snapwing::solver
