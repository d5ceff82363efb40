#pragma once
/// Inertia of a rigid body without cells in a step. Its points are at X + c + E X / L, X measured from the point whose
/// displacement is c. The mass matrix in the coordinates (c, E) is therefore constant and the same for each component,
///   B = [m, b^T / L; b / L, S / L^2],   b = sum of m X, S = sum of m X X^T.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "snapwing/solver/rotation.h"
#include "snapwing/solver/term.h"

namespace snapwing::solver {

struct RigidMass {
  double mass = 0;                                   ///< m [kg]
  Eigen::Vector3d first = Eigen::Vector3d::Zero();   ///< b [kg m]
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();  ///< S [kg m2], symmetric positive semidefinite
  /// Moments of a body: b = m X_c, S = tr(J)/2 I - J + m X_c X_c^T.
  /// @param mass  m [kg] > 0; @param centre  centre of mass X_c [m]
  /// @param inertia  tensor J about the centre [kg m2] (products of inertia with negative sign)
  /// @throws common::Error for a mass or an inertia that no body has (triangle inequality of the principal moments)
  static RigidMass of(double mass, const Eigen::Vector3d& centre, const Eigen::Matrix3d& inertia);
};

class RigidInertiaTerm : public Term {
 public:
  /// @param dimension    2 or 3
  /// @param centre       full coordinate of the first component of c
  /// @param rotation     of the body: place of the entries of E, and L
  RigidInertiaTerm(std::string name, int dimension, int centre, const Rotation& rotation, const RigidMass& mass);

  std::string name() const override { return name_; }
  Role role() const override { return Role::INERTIA; }
  std::vector<std::vector<int>> couples() const override { return couples_; }
  void evaluate(const Point& at, Order order, Sum& sum) const override;

  /// Linear momentum [kg m/s] at rates v [m/s] of the full coordinates; 2-D: z is 0.
  Eigen::Vector3d momentum(const Eigen::VectorXd& v) const;
  /// Angular momentum [kg m2/s] about the origin of X, at full coordinates y [m] and rates v [m/s]; 2-D: z only.
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
