#pragma once
/// Exact rotation of rigid groups of nodes.
///
/// A rigid node moves by u_i = c + E (X_i - X_c) / L with E = L (R - I), R a rotation. That is linear in c and in the
/// entries of E, so every support, port and joint of a rigid body stays a linear equation (Reduction), as long as none
/// of them eliminates an entry of E. What is left nonlinear is E(s), s = L theta, and `Coordinates` differentiates it
/// twice: R = I + a K + b (theta theta^T - |theta|^2 I), a = sin t / t, b = (1 - cos t) / t^2 (Rodrigues).

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "snapwing/solver/reduction.h"

namespace snapwing::solver {

/// How a rigid group may turn: not at all, about one axis that is fixed in space, or freely.
struct Rotation {
  int first = 0;      ///< dof of E_00; E_ij is dof first + i + D j
  double length = 1;  ///< L [m]
  /// None: E = 0. One: its unit vector. Three (volumetric): free; the rotation vector then must stay below 2 pi.
  std::vector<Eigen::Vector3d> axes;
};

/// E and its derivatives by s; entries in the order i + D j.
struct RotationValue {
  Eigen::VectorXd value;                ///< E [m], (D D)
  Eigen::MatrixXd slope;                ///< dE/ds [1], (D D x params)
  std::vector<Eigen::MatrixXd> second;  ///< d2E/ds2 [1/m], per entry (params x params)
};

/// @param dimension  2 or 3
/// @param s          L times the angles about the axes [m], one per axis
/// @param reference  R_ref of E = L (exp(s / L) R_ref - I), (3 x 3); null: I
RotationValue rotate(const Rotation& rotation, int dimension, const Eigen::VectorXd& s,
                     const Eigen::Matrix3d* reference = nullptr);

/// K with K x = n x x.
Eigen::Matrix3d skewOf(const Eigen::Vector3d& n);

/// Ways of turning that linear equations in the entries of E leave open.
/// @param name       of the rigid group, for messages
/// @param equations  homogeneous, in dofs first .. first + D D - 1 only
/// @param allowed    axes to choose from: all (the unit vectors), or one
/// @throws common::Error if they ask for a motion that is neither blocked, about one axis, nor free
template <int D>
std::vector<Eigen::Vector3d> openAxes(const Rotation& rotation, const std::vector<Equation>& equations,
                                      std::vector<Eigen::Vector3d> allowed, const std::string& name);

}  // namespace snapwing::solver
