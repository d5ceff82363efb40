#pragma once
/// The way from free coordinates z to full ones y, the only curved part of a problem:
///   y = T w + B p + c          linear elimination, constant and exact (Reduction)
///   w = z, but for the entries of E = L (exp(s / L) R_ref - 1) of each rigid rotation, which the last coordinates s
///       drive. R_ref is 1, or a reference that can be renewed, so that a body may turn for ever.

#include <Eigen/Core>
#include <memory>
#include <utility>
#include <vector>

#include "snapwing/solver/hessian_layout.h"
#include "snapwing/solver/reduction.h"
#include "snapwing/solver/rotation.h"
#include "snapwing/solver/sparse.h"

namespace snapwing::solver {

/// R_ref of each rotation in their order, (D x D part counts).
struct References {
  std::vector<Eigen::Matrix3d> rotation;
};

class Coordinates {
 public:
  /// What belongs to one (z, p, references); work space.
  struct Place {
    Eigen::VectorXd y;                     ///< full coordinates [m]
    std::vector<RotationValue> rotations;  ///< entries of E and their derivatives by s
  };

  /// @param dimension  2 or 3: a rotation has dimension^2 entries
  /// @param rotations  all their entries must be free in `linear`. @throws common::Error
  explicit Coordinates(Reduction linear, int dimension = 3, std::vector<Rotation> rotations = {});

  int freeCount() const { return free_; }
  int fullCount() const { return linear_.dofCount(); }
  int controlCount() const { return linear_.controlCount(); }
  int rotationCount() const { return static_cast<int>(groups_.size()); }
  const Reduction& linear() const { return linear_; }
  /// Length L of the rotation that each of the last coordinates turns [m].
  Eigen::VectorXd rotationLengths() const;

  /// @param references  null: all 1
  void at(const Eigen::VectorXd& z, const Eigen::VectorXd& p, const References* references, Place& out) const;
  /// y alone.
  Eigen::VectorXd expand(const Eigen::VectorXd& z, const Eigen::VectorXd& p,
                         const References* references = nullptr) const;
  /// Free coordinates that have the linear part of y, with the rotations' last coordinates given [m].
  Eigen::VectorXd freePart(const Eigen::VectorXd& y, const Eigen::VectorXd& rotations) const;
  /// J^T f, J = dy/dz. [N] for f in N
  Eigen::VectorXd pullBack(const Place& at, const Eigen::VectorXd& full) const;
  /// C J of rows C over full coordinates, (rows x free).
  ConstraintRows pullBack(const Place& at, const ConstraintRows& rows) const;
  /// The same with the mean of two places' rotations in the place of the slope: dE/ds = [axis] (R0 + R1) / 2. A step
  /// that tests its equations along these keeps energy and angular momentum. Equal to pullBack without rotations.
  Eigen::VectorXd pullBackMean(const Place& start, const Place& end, const Eigen::VectorXd& full) const;
  /// Rates of the last coordinates that come nearest to rates v of y: those of the rotations. [m/s]
  Eigen::VectorXd rotationRates(const Place& at, const Eigen::VectorXd& v) const;
  /// J dz + dy/dp dp [m]
  Eigen::VectorXd push(const Place& at, const Eigen::VectorXd& dz, const Eigen::VectorXd& dp) const;
  /// B^T f
  Eigen::VectorXd toControls(const Eigen::VectorXd& full) const { return linear_.restrictToControl(full); }
  /// R_ref := exp(s / L) R_ref, orthonormal to rounding, and s := 0 in z; y stays what it is.
  std::shared_ptr<const References> renew(Eigen::VectorXd& z, const References* references) const;

 private:
  friend class HessianPullBack;
  struct Group {
    Rotation rotation;
    std::vector<int> inner;  ///< coordinate w of each entry of E
    int first = 0;           ///< first s
    int params() const { return static_cast<int>(rotation.axes.size()); }
  };
  Eigen::VectorXd inner(const Eigen::VectorXd& z, const std::vector<RotationValue>& values) const;
  Eigen::VectorXd pullBackInner(const Eigen::VectorXd& inner, const std::vector<RotationValue>& values) const;

  Reduction linear_;
  int dimension_;
  std::vector<Group> groups_;
  std::vector<int> plain_;                     ///< w -> z, -1 for entries of E; empty without rotations
  std::vector<std::pair<int, int>> entry_of_;  ///< w -> rotation and entry of E, for those
  int free_ = 0;
};

/// J^T H J + sum_e (dE/dy)_e d2y_e/dz2 in a sparse pattern that is built once.
class HessianPullBack {
 public:
  HessianPullBack(std::shared_ptr<const Coordinates> coordinates, const HessianLayout& layout);
  const SparsePattern& pattern() const { return coordinates_.groups_.empty() ? inner_ : pattern_; }
  /// @param full       H in the order of the layout
  /// @param gradient   dE/dy of everything that the potential holds
  /// @param projected  keeps the rotations' own blocks from being negative
  void apply(const std::vector<double>& full, const Coordinates::Place& at, const Eigen::VectorXd& gradient,
             bool projected, std::vector<double>& values) const;

 private:
  struct Mixed {
    int target, source;
    double factor;
  };
  /// values[target] += times * slope[row] * slope[column] * inner[source]
  struct Item {
    int target, source, row, column;
    double times;
  };
  void buildInner(const HessianLayout& layout);
  void buildTurned();

  std::shared_ptr<const Coordinates> shared_;
  const Coordinates& coordinates_;
  SparsePattern inner_, pattern_;
  std::vector<int> source_;  ///< entry k is full[source_[k]] (0 if -1), then the few that mix are added
  std::vector<Mixed> mixed_;
  std::vector<int> slope_of_group_;  ///< place of dE/ds in the flat list of slopes, whose first value is 1
  int slopes_ = 1;
  std::vector<Item> items_;
};

}  // namespace snapwing::solver
