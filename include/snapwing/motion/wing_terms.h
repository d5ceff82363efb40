#pragma once
/// Terms between rigid bodies that rotate about z, and between such a body and a soft arm, as functions of the entries
/// E = L (R - I) of their rotations. Angles are atan2(E_10, L + E_00), positive about z of their plane.

#include <Eigen/Core>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "snapwing/solver/row.h"
#include "snapwing/solver/term.h"

namespace snapwing::motion {

/// The two entries of a rotation about z that define its angle.
struct Turning {
  int cosine = 0;                                ///< full coordinate of E_00 [m]
  int sine = 0;                                  ///< full coordinate of E_10 [m]
  double length = 1;                             ///< L [m]
  double sign = 1;                               ///< -1: the entries are of a rotation about -z of that plane
  double angle(const Eigen::VectorXd& y) const;  ///< in (-pi, pi] [rad]
};

/// The angle of a body about a pin's axis as a function of the full coordinates.
class PinAngle {
 public:
  virtual ~PinAngle() = default;
  virtual const std::vector<int>& coordinates() const = 0;
  virtual double at(const Eigen::VectorXd& y) const = 0;                  ///< in [-pi, pi] [rad]
  virtual Eigen::VectorXd slope(const Eigen::VectorXd& y) const = 0;      ///< gradient by coordinates() [1/m]
  virtual Eigen::MatrixXd curvature(const Eigen::VectorXd& y) const = 0;  ///< second derivatives [1/m2]
  /// Change of the angle in a step, each body by less than half a turn [rad]; its gradient and second derivatives with
  /// respect to y.
  virtual double between(const Eigen::VectorXd& from, const Eigen::VectorXd& y) const = 0;
  virtual Eigen::VectorXd slopeOver(const Eigen::VectorXd& from, const Eigen::VectorXd& y) const = 0;
  virtual Eigen::MatrixXd curvatureOver(const Eigen::VectorXd& from, const Eigen::VectorXd& y) const = 0;
};

/// The angle of a body, or of the first of two bodies relative to the second, in their plane.
class TurningAngle : public PinAngle {
 public:
  /// @param asker  first words of messages. @throws common::Error unless there are one or two bodies
  TurningAngle(const std::string& asker, std::vector<Turning> bodies);
  const std::vector<int>& coordinates() const override { return coordinates_; }
  double at(const Eigen::VectorXd& y) const override;
  double between(const Eigen::VectorXd& from, const Eigen::VectorXd& y) const override;
  Eigen::VectorXd slope(const Eigen::VectorXd& y) const override;
  Eigen::MatrixXd curvature(const Eigen::VectorXd& y) const override;
  Eigen::VectorXd slopeOver(const Eigen::VectorXd&, const Eigen::VectorXd& y) const override { return slope(y); }
  Eigen::MatrixXd curvatureOver(const Eigen::VectorXd&, const Eigen::VectorXd& y) const override {
    return curvature(y);
  }

 private:
  std::vector<Turning> bodies_;
  std::vector<int> coordinates_;
};

/// Joint between a wing's crank and its arm.
class Hub : public solver::Term {
 public:
  /// Mean rotation of the arm's nodes less the crank's [rad].
  virtual double twist(const Eigen::VectorXd& y) const = 0;
};

/// Stiff spring between a rigid body's rotation and the mean rotation of a soft body's nodes about a point: k/2 g^2,
///   g = (s(y) (L + E_00) - c(y) E_10) / (N L),   s, c = N times sine and cosine of that rotation, linear in y.
/// For small angles g is the angle between both, times the mean stretch of the nodes' distances from the point.
class HubTerm : public Hub {
 public:
  /// @param rotation_at_rest  gradient of the mean rotation with respect to the full coordinates at rest [1/m]
  /// @param nodes    full coordinates of the nodes' x displacements; y is the next one
  /// @param point    full coordinate of the point's x displacement; a translation with the point gives no rotation
  /// @param stiffness k [N m] > 0. @throws common::Error
  HubTerm(std::string name, const Eigen::VectorXd& rotation_at_rest, const std::vector<int>& nodes, int point,
          const Turning& body, double stiffness);
  std::string name() const override { return name_; }
  Role role() const override { return Role::STORED; }
  std::vector<std::vector<int>> couples() const override { return {coordinates_}; }
  void evaluate(const solver::Point& at, solver::Order order, solver::Sum& sum) const override;
  double twist(const Eigen::VectorXd& y) const override;

 private:
  Eigen::VectorXd pick(const Eigen::VectorXd& y) const;

  std::string name_;
  std::vector<int> coordinates_;   ///< of nodes and point, then the body's two
  Eigen::VectorXd sine_, cosine_;  ///< slopes of s/N and c/N by all but the body's two [1/m]
  Turning body_;
  double stiffness_;
};

/// Coulomb friction of a pin between two bodies, or of a body with a fixed pin: h M (sqrt(w^2 + w_0^2) - w_0), w the
/// step's mean rate of the angle. Zero in statics.
class PinFriction : public solver::Term {
 public:
  /// @param bodies  as of TurningAngle; @param moment  M [N m] >= 0; @param rate  w_0 [rad/s] > 0, below which the
  /// friction is regularised. @throws common::Error
  PinFriction(const std::string& name, std::vector<Turning> bodies, double moment, double rate);
  PinFriction(std::string name, std::shared_ptr<const PinAngle> angle, double moment, double rate);
  std::string name() const override { return name_; }
  Role role() const override { return Role::DISSIPATION; }
  std::vector<std::vector<int>> couples() const override { return {angle_->coordinates()}; }
  void evaluate(const solver::Point& at, solver::Order order, solver::Sum& sum) const override;

 private:
  std::string name_;
  std::shared_ptr<const PinAngle> angle_;
  double moment_, rate_;
};

/// Moment of the air against the rotation of a body, or of one relative to another: h k/3 |w|^3, w the step's mean rate
/// of the angle. Zero in statics.
class TurningDrag : public solver::Term {
 public:
  /// @param bodies  as of TurningAngle; @param coefficient  k [N m s2] >= 0. @throws common::Error
  TurningDrag(const std::string& name, std::vector<Turning> bodies, double coefficient);
  TurningDrag(std::string name, std::shared_ptr<const PinAngle> angle, double coefficient);
  std::string name() const override { return name_; }
  Role role() const override { return Role::DISSIPATION; }
  std::vector<std::vector<int>> couples() const override { return {angle_->coordinates()}; }
  void evaluate(const solver::Point& at, solver::Order order, solver::Sum& sum) const override;

 private:
  std::string name_;
  std::shared_ptr<const PinAngle> angle_;
  double coefficient_;
};

/// Cubic Hermite curve through points with given slopes, continued linearly beyond the ends.
class SmoothCurve {
 public:
  struct Value {
    double value = 0, first = 0, second = 0;  ///< value and derivatives
  };
  /// @param slope  empty: central differences. @throws common::Error for less than two points, another number of
  /// values, or an x that does not increase
  SmoothCurve(std::vector<double> x, std::vector<double> value, std::vector<double> slope = {});
  Value at(double x) const;

 private:
  std::vector<double> x_, value_, slope_;
};

/// Elastic energy [J] as a function of an angle.
class AngleEnergy : public solver::Term {
 public:
  /// @param bodies  as of TurningAngle; @param energy  [J] of the angle in (-pi, pi) [rad]. @throws common::Error
  AngleEnergy(const std::string& name, std::vector<Turning> bodies, SmoothCurve energy);
  AngleEnergy(std::string name, std::shared_ptr<const PinAngle> angle, SmoothCurve energy);
  std::string name() const override { return name_; }
  Role role() const override { return Role::STORED; }
  std::vector<std::vector<int>> couples() const override { return {angle_->coordinates()}; }
  void evaluate(const solver::Point& at, solver::Order order, solver::Sum& sum) const override;

 private:
  std::string name_;
  std::shared_ptr<const PinAngle> angle_;
  SmoothCurve energy_;
};

/// Penalty on the difference of a body's angle from a function of the travel, the arm's static path:
/// k/2 (angle - curve(u))^2.
class TravelHub : public solver::Term {
 public:
  /// @param travel  row of u; @param curve  angle [rad] of u [m]; @param stiffness  k [N m] > 0. @throws common::Error
  TravelHub(std::string name, const Turning& body, solver::Row travel, SmoothCurve curve, double stiffness);
  std::string name() const override { return name_; }
  Role role() const override { return Role::STORED; }
  std::vector<std::vector<int>> couples() const override { return {coordinates_}; }
  void evaluate(const solver::Point& at, solver::Order order, solver::Sum& sum) const override;

 private:
  std::string name_;
  Turning body_;
  solver::Row travel_;
  SmoothCurve curve_;
  double stiffness_;
  std::vector<int> coordinates_;
};

}  // namespace snapwing::motion
