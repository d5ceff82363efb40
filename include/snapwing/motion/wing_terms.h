#pragma once
/// What joins rigid bodies that turn about z with a soft arm and with each other, on the entries E = L (R - 1) of their
/// rotations. Angles are atan2(E_10, L + E_00), about z of the plane that they are counted in.

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "snapwing/solver/row.h"
#include "snapwing/solver/term.h"

namespace snapwing::motion {

/// Where the two entries of a rotation about z lie that say its angle.
struct Turning {
  int cosine = 0;                                ///< coordinate of E_00 [m]
  int sine = 0;                                  ///< coordinate of E_10 [m]
  double length = 1;                             ///< L [m]
  double sign = 1;                               ///< -1: the entries are of a rotation about -z of that plane
  double angle(const Eigen::VectorXd& y) const;  ///< in (-pi, pi] [rad]
};

/// The angle of a body, or of the first of two by the second's.
class TurningAngle {
 public:
  TurningAngle() = default;
  /// @throws common::Error unless there are one or two
  TurningAngle(const std::string& asker, std::vector<Turning> bodies);
  const std::vector<int>& coordinates() const { return coordinates_; }
  double at(const Eigen::VectorXd& y) const;                                    ///< in [-pi, pi] [rad]
  double between(const Eigen::VectorXd& from, const Eigen::VectorXd& y) const;  ///< how far it turned, each body by
                                                                                ///< less than half a turn [rad]
  Eigen::VectorXd slope(const Eigen::VectorXd& y) const;                        ///< by coordinates() [1/m]
  Eigen::MatrixXd curvature(const Eigen::VectorXd& y) const;                    ///< [1/m2]

 private:
  std::vector<Turning> bodies_;
  std::vector<int> coordinates_;
};

/// Holds a body in the mean rotation of a soft body's nodes about a point: k/2 g^2 with
///   g = (s(y) (L + E_00) - c(y) E_10) / (N L),   s, c = N times sine and cosine of that rotation, linear in y,
/// which is the angle between both, times how much the nodes' circle is stretched. STORED: a stiff spring.
class HubTerm : public solver::Term {
 public:
  /// @param rotation_at_rest  of the mean rotation by the coordinates, (coordinate, slope [1/m]) of nodes on circles
  ///        about the point: x and y of one node follow each other in `nodes`
  /// @param nodes    x coordinates of these nodes, (each y is the next coordinate)
  /// @param point    x coordinate of the point, whose motion does not turn them
  /// @param stiffness [N m] > 0. @throws common::Error
  HubTerm(std::string name, const Eigen::VectorXd& rotation_at_rest, const std::vector<int>& nodes, int point,
          const Turning& body, double stiffness);
  std::string name() const override { return name_; }
  Role role() const override { return Role::STORED; }
  std::vector<std::vector<int>> couples() const override { return {coordinates_}; }
  void evaluate(const solver::Point& at, solver::Order order, solver::Sum& sum) const override;
  /// Mean rotation of the nodes less the body's [rad].
  double twist(const Eigen::VectorXd& y) const;

 private:
  Eigen::VectorXd pick(const Eigen::VectorXd& y) const;

  std::string name_;
  std::vector<int> coordinates_;   ///< of nodes and point, then the body's two
  Eigen::VectorXd sine_, cosine_;  ///< slopes of s/N and c/N by all but the body's two [1/m]
  Turning body_;
  double stiffness_;
};

/// Coulomb friction of a pin between two bodies, or a body and the ring: h M (sqrt(w^2 + w_0^2) - w_0), w the step's
/// mean rate of the angle between them.
class PinFriction : public solver::Term {
 public:
  /// @param bodies  as of TurningAngle; @param moment  M [N m] >= 0; @param rate  w_0 [rad/s] > 0
  /// @throws common::Error
  PinFriction(std::string name, std::vector<Turning> bodies, double moment, double rate);
  std::string name() const override { return name_; }
  Role role() const override { return Role::DISSIPATION; }
  std::vector<std::vector<int>> couples() const override { return {angle_.coordinates()}; }
  void evaluate(const solver::Point& at, solver::Order order, solver::Sum& sum) const override;

 private:
  std::string name_;
  TurningAngle angle_;
  double moment_, rate_;
};

/// Moment of the air against the turning of a body, or of one by another: h k/3 |w|^3, w the step's mean rate.
class TurningDrag : public solver::Term {
 public:
  /// @param bodies  as of TurningAngle; @param coefficient  k [N m s2] >= 0. @throws common::Error
  TurningDrag(const std::string& name, std::vector<Turning> bodies, double coefficient);
  std::string name() const override { return name_; }
  Role role() const override { return Role::DISSIPATION; }
  std::vector<std::vector<int>> couples() const override { return {angle_.coordinates()}; }
  void evaluate(const solver::Point& at, solver::Order order, solver::Sum& sum) const override;

 private:
  std::string name_;
  TurningAngle angle_;
  double coefficient_;
};

/// A smooth curve through points: cubics with given slopes, straight beyond the ends.
class SmoothCurve {
 public:
  struct Value {
    double value = 0, first = 0, second = 0;  ///< and derivatives
  };
  /// @param slope  empty: central differences. @throws common::Error for less than two points or an x that does not
  /// grow
  SmoothCurve(std::vector<double> x, std::vector<double> value, std::vector<double> slope = {});
  Value at(double x) const;

 private:
  std::vector<double> x_, value_, slope_;
};

/// Elastic energy against an angle [J].
class AngleEnergy : public solver::Term {
 public:
  /// @param bodies  as of TurningAngle; @param energy  by the angle [rad] in (-pi, pi). @throws common::Error
  AngleEnergy(const std::string& name, std::vector<Turning> bodies, SmoothCurve energy);
  std::string name() const override { return name_; }
  Role role() const override { return Role::STORED; }
  std::vector<std::vector<int>> couples() const override { return {angle_.coordinates()}; }
  void evaluate(const solver::Point& at, solver::Order order, solver::Sum& sum) const override;

 private:
  std::string name_;
  TurningAngle angle_;
  SmoothCurve energy_;
};

/// Penalty that keeps a body's angle on a curve of the travel, the arm's static path: k/2 (angle - curve(u))^2.
class TravelHub : public solver::Term {
 public:
  /// @param curve  angle by the travel [rad] of [m]; @param stiffness  k [N m] > 0. @throws common::Error
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
