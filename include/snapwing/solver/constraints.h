#pragma once
/// Constraints that are kept as equations instead of being eliminated. They are linear in full coordinates,
///   g(y; p) = C y - D p - e = 0,    L = Pi + lambda . g + rho/2 |g|^2,
/// joints between rigid bodies included. Their rows in the free coordinates at a point are C J, J = dy/dz. The penalty
/// term is zero at a solution. The augmented Lagrangian method needs it, and it makes the Hessian of L regular where
/// only constraints hold a body. The force on a control is dL/dp = dPi/dp - D^T lambda at a solution: the reaction of a
/// driven port is its multiplier. Multipliers belong to the state of a solution (`Equilibrium`), not to the problem.

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "snapwing/solver/coordinates.h"
#include "snapwing/solver/enforcement.h"
#include "snapwing/solver/sparse.h"

namespace snapwing::solver {

/// Numerical rank of the rows of C.
struct RowRank {
  int rank = 0;                ///< singular values above `threshold` times the largest
  double smallest = 0;         ///< smallest singular value over the largest [1]
  std::vector<int> dependent;  ///< rows with large entries in the left vector of the smallest singular value
};
/// @param threshold  [1]. Rank 0 for no rows, or more rows than columns. Cost: dense QR and SVD
RowRank rankOf(const ConstraintRows& rows, double threshold = 1e-8);

struct LinearRows {
  ConstraintRows rows;             ///< C, (equations x full coordinates)
  Eigen::MatrixXd control;         ///< D, (equations x controls)
  Eigen::VectorXd constant;        ///< e [m], (equations x 1)
  std::vector<std::string> names;  ///< of the support, port or joint of each row, for messages
  std::vector<int> equation;       ///< index of each row's Equation in the original list; -1: of several
  int count() const { return static_cast<int>(constant.size()); }
  /// g [m], (equations x 1)
  Eigen::VectorXd residual(const Eigen::VectorXd& y, const Eigen::VectorXd& p) const {
    return rows * y - control * p - constant;
  }
  /// The same equations with the eliminated coordinates substituted; D and e change accordingly.
  LinearRows onFree(const Reduction& reduction) const;
};

class Constraints {
 public:
  /// @param enforcement  AUGMENTED_LAGRANGIAN or MULTIPLIERS
  /// @param penalty      rho [N/m] >= 0; above 0 for the augmented Lagrangian
  /// @param tolerance    [m] > 0, on the residual of every equation
  /// @param redundant    number of rows C J that depend on the others wherever all equations hold (redundantRows)
  /// @throws common::Error for values out of range and sizes that do not fit
  Constraints(LinearRows rows, Enforcement enforcement, double penalty, double tolerance, int redundant = 0);

  int count() const { return rows_.count(); }
  int redundant() const { return redundant_; }
  const LinearRows& linear() const { return rows_; }
  const Eigen::MatrixXd& control() const { return rows_.control; }  ///< D
  Enforcement enforcement() const { return enforcement_; }
  double penalty() const { return penalty_; }      ///< rho [N/m]
  double tolerance() const { return tolerance_; }  ///< [m]
  /// g [m], (equations x 1)
  Eigen::VectorXd residual(const Eigen::VectorXd& y, const Eigen::VectorXd& p) const { return rows_.residual(y, p); }
  /// With the eliminated coordinates substituted (LinearRows::onFree).
  Constraints onFree(const Reduction& reduction) const;
  /// Names of rows, without repetitions, e.g. "'pin a', 'pin b'".
  std::string nameRows(const std::vector<int>& rows) const;

 private:
  LinearRows rows_;
  Enforcement enforcement_;
  double penalty_, tolerance_;
  int redundant_;
};

/// Result of splitEquations().
struct SplitEquations {
  Reduction eliminated;
  LinearRows kept;
  /// Per rotation: homogeneous equations in its entries only, without control. They decide its free axes (openAxes).
  std::vector<std::vector<Equation>> of_rotation;
};

/// Splits equations into eliminated and kept ones. Kept are the `keepable` ones if `keep` is true, and always those of
/// which elimination leaves entries of several rotations (closed chains) or that drive a rotation. Redundant equations,
/// such as a joint at a driven port, are dropped.
/// @param full, controls  numbers of full coordinates and of controls
/// @param first_entry  full coordinate of the first rotation's first entry; the rotations are consecutive
/// @param rotations    number of rotations, of `entries` coordinates each
/// @throws common::Error naming the equation that contradicts earlier ones
SplitEquations splitEquations(int full, int controls, const std::vector<Equation>& equations, bool keep,
                              int first_entry, int rotations, int entries);

/// Number of rows C J that depend on the others wherever the equations hold, such as those of parallel pins in space.
/// The rank is determined at a configuration turned a little from rest, because at rest it may be lower (dead point).
/// @param travel  [m] value of the controls at this configuration; both signs are tried
/// @throws common::Error naming equations that cannot hold at the same time
int redundantRows(const Coordinates& coordinates, const LinearRows& rows, double travel);

}  // namespace snapwing::solver
