#pragma once
/// Constraints that are kept as equations instead of being eliminated. They are linear in full coordinates,
///   g(y; p) = C y - D p - e = 0,    L = Pi + lambda . g + rho/2 |g|^2,
/// so a joint between rigid bodies is one; at a point their rows by the free coordinates are C J, J = dy/dz. The last
/// term vanishes at a solution. The augmented Lagrangian method needs it, and it makes the Hessian of L regular where
/// constraints alone hold a body. The force that holds a control is dL/dp = dPi/dp - D^T lambda: the reaction of a
/// driven port is its multiplier. Multipliers belong to the state of a solution (`Equilibrium`), not to the problem.

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "snapwing/solver/coordinates.h"
#include "snapwing/solver/enforcement.h"
#include "snapwing/solver/sparse.h"

namespace snapwing::solver {

/// How far the rows of C are from depending on each other.
struct RowRank {
  int rank = 0;                ///< singular values above `threshold` times the largest
  double smallest = 0;         ///< smallest singular value over the largest [1]
  std::vector<int> dependent;  ///< rows with a large share in the smallest one's left vector
};
RowRank rankOf(const ConstraintRows& rows, double threshold = 1e-8);

struct LinearRows {
  ConstraintRows rows;             ///< C, (equations x full coordinates)
  Eigen::MatrixXd control;         ///< D, (equations x controls)
  Eigen::VectorXd constant;        ///< e [m]
  std::vector<std::string> names;  ///< of what asks for each, for messages
  std::vector<int> equation;       ///< number in the list that each came from; -1: follows from several
  int count() const { return static_cast<int>(constant.size()); }
  /// g [m]
  Eigen::VectorXd residual(const Eigen::VectorXd& y, const Eigen::VectorXd& p) const {
    return rows * y - control * p - constant;
  }
  /// The same equations in the coordinates that an elimination leaves free; D and e take up what it says of the others.
  LinearRows onFree(const Reduction& reduction) const;
};

class Constraints {
 public:
  /// @param enforcement  AUGMENTED_LAGRANGIAN or MULTIPLIERS
  /// @param penalty      rho [N/m] >= 0; above 0 for the augmented Lagrangian
  /// @param tolerance    [m] > 0, on every equation
  /// @param redundant    how many of the rows C J follow from the others wherever all equations hold
  /// @throws common::Error for values out of range and sizes that do not fit
  Constraints(LinearRows rows, Enforcement enforcement, double penalty, double tolerance, int redundant = 0);

  int count() const { return rows_.count(); }
  int redundant() const { return redundant_; }
  const LinearRows& linear() const { return rows_; }
  const Eigen::MatrixXd& control() const { return rows_.control; }  ///< D
  Enforcement enforcement() const { return enforcement_; }
  double penalty() const { return penalty_; }      ///< rho [N/m]
  double tolerance() const { return tolerance_; }  ///< [m]
  Eigen::VectorXd residual(const Eigen::VectorXd& y, const Eigen::VectorXd& p) const { return rows_.residual(y, p); }
  /// The same on the coordinates that an elimination leaves free.
  Constraints onFree(const Reduction& reduction) const;
  /// Names of rows, each once, e.g. "'pin a', 'pin b'".
  std::string nameRows(const std::vector<int>& rows) const;

 private:
  LinearRows rows_;
  Enforcement enforcement_;
  double penalty_, tolerance_;
  int redundant_;
};

/// What a list of equations becomes.
struct SplitEquations {
  Reduction eliminated;
  LinearRows kept;
  /// Equations in the entries of one rotation, homogeneous and without control: they decide how it may turn.
  std::vector<std::vector<Equation>> of_rotation;
};

/// Splits equations into those that are eliminated and those that are kept: the `keepable` ones if that is wanted, and
/// always those of which elimination leaves entries of several rotations (closed chains) or that drive a rotation.
/// What repeats others, as a joint at a driven port, is dropped.
/// @param first_entry  full coordinate of the first rotation's first entry; rotations follow each other
/// @param rotations    number of rotations, of `entries` coordinates each
/// @throws common::Error naming the equation that contradicts earlier ones
SplitEquations splitEquations(int full, int controls, const std::vector<Equation>& equations, bool keep,
                              int first_entry, int rotations, int entries);

/// How many rows C J follow from the others wherever the equations hold, as those of parallel pins in space do: the
/// rank at a place that is turned a little from rest. That at rest itself may be less (a dead point).
/// @param travel  [m] by which driven equations are moved to see whether they can be
/// @throws common::Error naming equations that cannot hold together
int redundantRows(const Coordinates& coordinates, const LinearRows& rows, double travel);

}  // namespace snapwing::solver
