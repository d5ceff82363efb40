#pragma once
/// Terms of points of bodies in space: drag of a point, what acts along the line between two points, propellers. What
/// acts between bodies lies along the line between their points at the middle of the step, so that a step that keeps
/// angular momentum keeps it with these.

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "snapwing/solver/rotation.h"
#include "snapwing/solver/term.h"

namespace snapwing::solver {

/// A point whose place is linear in the full coordinates: x = rest + A y.
class SpacePoint {
 public:
  SpacePoint() = default;
  /// Of a rigid body: rest + c + E (rest - centre) / L.
  /// @param centre_at  coordinate of the first component of c; @param centre  what c is the displacement of [m]
  SpacePoint(const Eigen::Vector3d& rest, int centre_at, const Rotation& rotation, const Eigen::Vector3d& centre);
  /// a - b: the way from b to a.
  static SpacePoint between(const SpacePoint& a, const SpacePoint& b);

  Eigen::Vector3d at(const Eigen::VectorXd& y) const { return rest_ + displacement(y); }  ///< [m]
  Eigen::Vector3d displacement(const Eigen::VectorXd& y) const { return matrix_ * pick(y); }
  const std::vector<int>& coordinates() const { return coordinates_; }
  const Eigen::Matrix3Xd& matrix() const { return matrix_; }  ///< A by these coordinates
  void addTo(const Eigen::Vector3d& force, Eigen::VectorXd& gradient) const;
  Eigen::VectorXd pick(const Eigen::VectorXd& y) const;

 private:
  Eigen::Vector3d rest_ = Eigen::Vector3d::Zero();
  std::vector<int> coordinates_;
  Eigen::Matrix3Xd matrix_;
};

/// Drag k |v| v of a point, v the step's mean velocity: h k/3 |v|^3.
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

/// Dashpot between two points: h c/2 w^2, w the mean rate of their distance along the mean of both ends' lines. That
/// line is held in the Hessian.
class StrutDamper : public Term {
 public:
  /// @param line  between the points; @param damping  c [N s/m] >= 0
  /// @param behind  acts only in steps that begin with a shorter line [m]; infinity: always. @throws common::Error
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

/// Stop that keeps two points at least a length apart: k/2 (length - l)^2 where their distance l is less.
class StrutStop : public Term {
 public:
  /// @param stiffness  k [N/m] > 0; @param length  [m] > 0. @throws common::Error
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

/// A propeller on a rigid body: thrust T along an axis of the body, which follows it, the yaw moment k T about that
/// axis, and a thrust that falls with the speed along it, T - sqrt(T T_full) v / v_none, as that of a blade of fixed
/// pitch. The axis is that of the step's middle as the rates at its start tell it, and held during the step.
class Propeller : public Term {
 public:
  struct Data {
    Eigen::Vector3d axis = Eigen::Vector3d::UnitY();  ///< of the thrust at rest, a unit vector
    int control = 0;                                  ///< that is T [N]
    double moment = 0;                                ///< k [m] of the body about the axis, with its sense
    double full_thrust = 1;                           ///< T_full [N] > 0
    double no_thrust_speed = 0;                       ///< v_none of full thrust [m/s]; 0: thrust does not fall
  };
  /// @param hub  on the body whose rotation is given. @throws common::Error
  Propeller(std::string name, SpacePoint hub, const Rotation& rotation, const Data& data);
  std::string name() const override { return name_; }
  Role role() const override { return Role::LOAD; }
  std::vector<std::vector<int>> couples() const override { return {hub_.coordinates()}; }
  void evaluate(const Point& at, Order order, Sum& sum) const override;
  /// Of the thrust; what falls with speed is held.
  void controlTangent(const Point& at, const Eigen::VectorXd& dy, const Eigen::VectorXd& dp, Eigen::VectorXd& by_y,
                      Eigen::VectorXd& by_p) const override;

 private:
  struct Held {
    Eigen::Vector3d axis;    ///< in the world
    Eigen::Matrix3d couple;  ///< by the entries of E, per unit of thrust [1]
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
