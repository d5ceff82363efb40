#pragma once
/// Exact rotation of rigid groups of nodes.
///
/// The displacement of a rigid node is u_i = c + E (X_i - X_c) / L with E = L (R - I), R a rotation. It is linear in c
/// and in the entries of E. Every support, port and joint of a rigid body is therefore a linear equation (Reduction),
/// as long as none of them eliminates an entry of E. Only E(s), s = L theta, is nonlinear (Rodrigues, t = |theta|):
///   R = I + a K + b (theta theta^T - t^2 I),   K x = theta x x,   a = sin t / t,   b = (1 - cos t) / t^2

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "snapwing/solver/reduction.h"

namespace snapwing::solver {

/// Rotation of a rigid group: none, about one axis that is fixed in space, or free.
struct Rotation {
  int first = 0;      ///< full coordinate of E_00; E_ij is first + i + D j
  double length = 1;  ///< L [m]
  /// Free axes, unit vectors. None: E = 0. One: rotation about it. Three (3-D): free; |theta| must stay below 2 pi.
  std::vector<Eigen::Vector3d> axes;
};

/// E and its derivatives with respect to s; entries in the order i + D j.
struct RotationValue {
  Eigen::VectorXd value;                ///< E [m], (D D)
  Eigen::MatrixXd slope;                ///< dE/ds [1], (D D x params)
  std::vector<Eigen::MatrixXd> second;  ///< d2E/ds2 [1/m], per entry (params x params)
};

/// Evaluates E(s).
/// @param dimension  D, 2 or 3
/// @param s          L times the rotation vector's components along the axes [m], one per axis
/// @param reference  R_ref of E = L (exp(s / L) R_ref - I), (3 x 3); null: I
RotationValue rotate(const Rotation& rotation, int dimension, const Eigen::VectorXd& s,
                     const Eigen::Matrix3d* reference = nullptr);

/// K with K x = n x x (cross product).
Eigen::Matrix3d skewOf(const Eigen::Vector3d& n);

/// Free rotation axes that linear equations in the entries of E leave.
/// @param name       of the rigid group, for messages
/// @param equations  homogeneous, in full coordinates first .. first + D D - 1 only
/// @param allowed    axes to choose from: the three unit vectors, or one
/// @throws common::Error if the remaining rotation is neither zero, about one axis, nor free
template <int D>
std::vector<Eigen::Vector3d> openAxes(const Rotation& rotation, const std::vector<Equation>& equations,
                                      std::vector<Eigen::Vector3d> allowed, const std::string& name);

}  // namespace snapwing::solver
