#pragma once
/// Inertia of a rigid body that has no cells, in a step: its points are X + c + E X / L, so that its mass matrix in the
/// coordinates (c, E) is constant and the same for each component,
///   B = [m, b^T / L; b / L, S / L^2],   b = sum of m X, S = sum of m X X^T
/// about the point that c is the displacement of.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "snapwing/solver/rotation.h"
#include "snapwing/solver/term.h"

namespace snapwing::solver {

struct RigidMass {
  double mass = 0;                                   ///< m [kg]
  Eigen::Vector3d first = Eigen::Vector3d::Zero();   ///< b [kg m]
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();  ///< S [kg m2], symmetric, not negative
  /// Of a body with its centre at X_c and the inertia tensor J about it (moments J_ii, products negative): S is what
  /// belongs to them. @throws common::Error for masses and inertias that no body has
  static RigidMass of(double mass, const Eigen::Vector3d& centre, const Eigen::Matrix3d& inertia);
};

class RigidInertiaTerm : public Term {
 public:
  /// @param dimension    2 or 3
  /// @param centre       full coordinate of the first component of c
  /// @param rotation     whose entries E are
  RigidInertiaTerm(std::string name, int dimension, int centre, const Rotation& rotation, const RigidMass& mass);

  std::string name() const override { return name_; }
  Role role() const override { return Role::INERTIA; }
  std::vector<std::vector<int>> couples() const override { return couples_; }
  void evaluate(const Point& at, Order order, Sum& sum) const override;

  /// Linear momentum [kg m/s] at rates v of the full coordinates, in the plane with zeros.
  Eigen::Vector3d momentum(const Eigen::VectorXd& v) const;
  /// Angular momentum about the origin of the body's reference [kg m2/s], at full coordinates y and rates v.
  Eigen::Vector3d angularMomentum(const Eigen::VectorXd& y, const Eigen::VectorXd& v) const;
  double kineticEnergy(const Eigen::VectorXd& v) const;  ///< [J]

 private:
  Eigen::VectorXd pick(const Eigen::VectorXd& full, int component) const;

  std::string name_;
  int dimension_;
  double length_;
  std::vector<std::vector<int>> couples_;  ///< per component: c_i, E_i0, E_i1 ...
  Eigen::MatrixXd block_;                  ///< B [kg]
};

}  // namespace snapwing::solver
