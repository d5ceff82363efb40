#pragma once
/// Map from free coordinates z to full coordinates y, the only nonlinear part of a problem's kinematics:
///   y = T w + B p + c          linear elimination, constant and exact (Reduction)
///   w = z, except the entries of E = L (exp(s / L) R_ref - I) of each rigid rotation, which are functions of the last
///       free coordinates s. R_ref is I or a reference that renew() updates, so that a body may turn without limit.

#include <Eigen/Core>
#include <memory>
#include <utility>
#include <vector>

#include "snapwing/solver/hessian_layout.h"
#include "snapwing/solver/reduction.h"
#include "snapwing/solver/rotation.h"
#include "snapwing/solver/sparse.h"

namespace snapwing::solver {

/// R_ref of each rotation, in their order; in 2-D only the upper left 2 x 2 block is used.
struct References {
  std::vector<Eigen::Matrix3d> rotation;
};

class Coordinates {
 public:
  /// Values at one (z, p, references); work space.
  struct Place {
    Eigen::VectorXd y;                     ///< full coordinates [m]
    std::vector<RotationValue> rotations;  ///< entries of E and their derivatives with respect to s
  };

  /// @param dimension  2 or 3: a rotation has dimension^2 entries
  /// @param rotations  their entries must all be free in `linear`. @throws common::Error naming an eliminated one
  explicit Coordinates(Reduction linear, int dimension = 3, std::vector<Rotation> rotations = {});

  int freeCount() const { return free_; }
  int fullCount() const { return linear_.dofCount(); }
  int controlCount() const { return linear_.controlCount(); }
  int rotationCount() const { return static_cast<int>(groups_.size()); }
  const Reduction& linear() const { return linear_; }
  /// Length L of the rotation to which each of the last coordinates s belongs [m].
  Eigen::VectorXd rotationLengths() const;

  /// @param z  (free x 1) [m]; @param p  (controls x 1); @param references  null: all I
  void at(const Eigen::VectorXd& z, const Eigen::VectorXd& p, const References* references, Place& out) const;
  /// y only [m], (full x 1).
  Eigen::VectorXd expand(const Eigen::VectorXd& z, const Eigen::VectorXd& p,
                         const References* references = nullptr) const;
  /// Free coordinate that is the full coordinate y_dof itself; -1 if none is.
  int freeOf(int dof) const;
  /// Free coordinates of y, with the last ones, s [m], given. @param rotations  s, (size of rotationLengths() x 1)
  Eigen::VectorXd freePart(const Eigen::VectorXd& y, const Eigen::VectorXd& rotations) const;
  /// J^T f, J = dy/dz. (free x 1) [N] for f in N
  Eigen::VectorXd pullBack(const Place& at, const Eigen::VectorXd& full) const;
  /// C J of rows C over full coordinates, (rows x free).
  ConstraintRows pullBack(const Place& at, const ConstraintRows& rows) const;
  /// As pullBack, with dE/ds replaced by [axis]x (R0 + R1) / 2, the mean of both places' rotations. A step whose
  /// residual is pulled back in this way conserves energy and angular momentum. Equal to pullBack without rotations.
  Eigen::VectorXd pullBackMean(const Place& start, const Place& end, const Eigen::VectorXd& full) const;
  /// Rates ds/dt of the rotations' coordinates that fit the rates v [m/s] of y best (least squares). [m/s]
  Eigen::VectorXd rotationRates(const Place& at, const Eigen::VectorXd& v) const;
  /// J dz + dy/dp dp [m]
  Eigen::VectorXd push(const Place& at, const Eigen::VectorXd& dz, const Eigen::VectorXd& dp) const;
  /// B^T f, (controls x 1)
  Eigen::VectorXd toControls(const Eigen::VectorXd& full) const { return linear_.restrictToControl(full); }
  /// Sets s := 0 in z and returns R_ref := exp(s / L) R_ref, made orthonormal; y does not change.
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

/// Hessian in the free coordinates, J^T H J + sum_e (dPi/dy)_e d2y_e/dz2, in a sparse pattern that is built once.
class HessianPullBack {
 public:
  HessianPullBack(std::shared_ptr<const Coordinates> coordinates, const HessianLayout& layout);
  const SparsePattern& pattern() const { return coordinates_.groups_.empty() ? inner_ : pattern_; }
  /// @param full       H in the order of the layout [N/m]
  /// @param gradient   dPi/dy of the whole potential [N]
  /// @param projected  sets negative eigenvalues of the rotations' second-order blocks to zero
  /// @param values     result in the order of pattern() [N/m]
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
  std::vector<int> source_;  ///< entry k is full[source_[k]], or what mixed_ makes of it
  std::vector<Mixed> mixed_;
  std::vector<int> slope_of_group_;  ///< index of dE/ds in the flat list of slopes, whose first value is 1
  int slopes_ = 1;
  std::vector<Item> items_;
};

}  // namespace snapwing::solver
