#pragma once
/// What joins rigid bodies that turn about z with a soft arm and with each other, on the entries E = L (R - 1) of their
/// rotations. Angles are atan2(E_10, L + E_00).

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
  double angle(const Eigen::VectorXd& y) const;  ///< in (-pi, pi] [rad]
};

/// Holds a body in the mean rotation of a soft body's nodes about a point: k/2 g^2 with
///   g = (s(y) (L + E_00) - c(y) E_10) / (N L),   s, c = N times sine and cosine of that rotation, linear in y,
/// which is the angle between both, times how much the nodes' circle is stretched. STORED: a stiff spring.
class HubTerm : public solver::Term {
 public:
  /// @param rotation_at_rest  of the mean rotation by the coordinates, (coordinate, slope [1/m]) of nodes on circles
  ///        about the point: x and y of one node follow each other in `nodes`
  /// @param nodes    x coordinates of these nodes, (each y is the next coordinate)
  /// @param carrier  coordinate that moves nodes along y without turning them; -1: none
  /// @param stiffness [N m] > 0. @throws common::Error
  HubTerm(std::string name, const Eigen::VectorXd& rotation_at_rest, const std::vector<int>& nodes, int carrier,
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
  std::vector<int> coordinates_;   ///< of nodes and carrier, then the body's two
  Eigen::VectorXd sine_, cosine_;  ///< slopes of s/N and c/N by all but the body's two [1/m]
  Turning body_;
  double stiffness_;
};

/// Coulomb friction of a pin between two bodies, or a body and the ring: h M (sqrt(w^2 + w_0^2) - w_0), w the step's
/// mean rate of the angle between them.
class PinFriction : public solver::Term {
 public:
  /// @param bodies  one, or two whose difference counts; @param moment  M [N m] >= 0; @param rate  w_0 [rad/s] > 0
  /// @throws common::Error
  PinFriction(std::string name, std::vector<Turning> bodies, double moment, double rate);
  std::string name() const override { return name_; }
  Role role() const override { return Role::DISSIPATION; }
  std::vector<std::vector<int>> couples() const override { return {coordinates_}; }
  void evaluate(const solver::Point& at, solver::Order order, solver::Sum& sum) const override;

 private:
  std::string name_;
  std::vector<Turning> bodies_;
  std::vector<int> coordinates_;
  double moment_, rate_;
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

/// Elastic energy against the angle of a body [J].
class AngleEnergy : public solver::Term {
 public:
  /// @param energy  by the angle [rad] in (-pi, pi)
  AngleEnergy(std::string name, const Turning& body, SmoothCurve energy)
      : name_(std::move(name)), body_(body), energy_(std::move(energy)) {}
  std::string name() const override { return name_; }
  Role role() const override { return Role::STORED; }
  std::vector<std::vector<int>> couples() const override { return {{body_.cosine, body_.sine}}; }
  void evaluate(const solver::Point& at, solver::Order order, solver::Sum& sum) const override;

 private:
  std::string name_;
  Turning body_;
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
