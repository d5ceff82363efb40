#pragma once
/// The wings' linkages in a vehicle along its axis: full coordinates (displacement of the axle's point and rotation of
/// each bar), the pins as equations, and the terms that they add. A closed chain keeps its last pin as an equation.

#include <memory>
#include <vector>

#include "snapwing/motion/wing_linkage.h"
#include "snapwing/motion/wing_terms.h"
#include "snapwing/solver/reduction.h"
#include "snapwing/solver/rotation.h"

namespace snapwing::motion {

class WingAssembly {
 public:
  struct Wing {
    bool left = true;
    double weight = 1;    ///< how many wings it stands for, in the problem [1] > 0
    double friction = 1;  ///< times the layout's friction at its pins [1] >= 0
  };
  WingAssembly() = default;
  /// @param first  full coordinate of the first; all of them follow each other
  WingAssembly(std::shared_ptr<const WingLinkage> linkage, std::vector<Wing> wings, int dimension, int first);

  int wingCount() const { return static_cast<int>(wings_.size()); }
  int count() const { return bodies() * (dimension_ + dimension_ * dimension_); }  ///< of full coordinates
  int firstEntry() const { return first_ + bodies() * dimension_; }                ///< of the first rotation
  int rotationCount() const { return bodies(); }
  std::vector<solver::Rotation> rotations() const;
  /// @param ring  coordinate of the ring's place along the axis; -1: it stands still
  std::vector<solver::Equation> equations(int ring) const;
  std::vector<std::shared_ptr<const solver::Term>> inertia() const;
  /// Friction at the pins, each its own, and stored energy, if the bars have any.
  std::vector<std::shared_ptr<const solver::Term>> pins() const;
  /// Keeps a wing from turning back past rest: a spring that acts below 0. @param stiffness  [N m] per rad > 0
  std::shared_ptr<const solver::Term> stop(int wing, double stiffness) const;
  /// Joins the crank of a wing with its arm. @param rotation_at_rest  gradient of the arm's rotation by the coordinates
  std::shared_ptr<const HubTerm> hub(int wing, const Eigen::VectorXd& rotation_at_rest, int carrier,
                                     double stiffness) const;
  /// Constrains the crank to the travel instead. @param curve  arm's rotation by the travel
  std::shared_ptr<const solver::Term> travelHub(int wing, const solver::Row& travel, const SmoothCurve& curve,
                                                double stiffness) const;
  double mass() const;  ///< of all wings with their weight [kg]
  /// 1 at the displacements along the axis.
  void markUp(Eigen::VectorXd& up) const;
  /// L times the angle of each rotation where every arm has turned by `crank` [m].
  Eigen::VectorXd turned(double crank) const;
  /// Rotation of a wing from rest [rad]. @param expected  near which it is looked for
  double wingAngle(const Eigen::VectorXd& y, int wing, double expected) const;
  Turning turning(int wing, WingLinkage::Body body) const;

 private:
  int bodies() const { return 3 * wingCount(); }
  int place(int wing, int body) const { return first_ + dimension_ * (3 * wing + body); }
  int entry(int wing, int body) const { return firstEntry() + dimension_ * dimension_ * (3 * wing + body); }
  std::vector<std::pair<int, double>> point(int wing, int body, const Eigen::Vector2d& at, int axis) const;

  std::shared_ptr<const WingLinkage> linkage_;
  std::vector<Wing> wings_;
  int dimension_ = 2, first_ = 0;
};

}  // namespace snapwing::motion
