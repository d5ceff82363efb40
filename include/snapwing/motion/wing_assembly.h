#pragma once
/// The wings' linkages in a vehicle, each in the plane of its arm and in that arm's axes: full coordinates
/// (displacement of the axle's point and rotation of each bar), the pins as equations, and the terms that they add. A
/// closed chain keeps its last pin as an equation.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "snapwing/motion/wing_linkage.h"
#include "snapwing/motion/wing_terms.h"
#include "snapwing/solver/constraints.h"
#include "snapwing/solver/reduction.h"
#include "snapwing/solver/rotation.h"

namespace snapwing::motion {

/// What acts on a wing beside its pins and bars; 0: not there. All are assumptions of a trial.
struct WingForces {
  double rest_stop = 0;  ///< [N m] per rad below 0: keeps the wing from turning back past rest, as taut film does
  double fold_bias = 0;  ///< [N m] steady moment towards folded: the central fold of the surface, sewn to bias it
  /// [N m] per rad: keeps the crank from turning further than its wing was designed for (the end of the wing's table).
  double fold_stop = 0;
  double air = 0;  ///< [N m s2] moment of still air against the wing's turning / rate squared
};

class WingAssembly {
 public:
  struct Wing {
    bool left = true;
    double weight = 1;    ///< how many wings it stands for, in the problem [1] > 0
    double friction = 1;  ///< times the layout's friction at its pins [1] >= 0
    /// How the ring turns in this wing's plane; none: it does not.
    std::optional<Turning> ring = {};
  };
  /// Displacement along an axis (0: x, 1: y) of a wing's plane of a point that the ring carries, by full coordinates.
  /// @param at  in the linkage's frame at rest [m]
  using OnRing = std::function<std::vector<std::pair<int, double>>(int wing, const Eigen::Vector2d& at, int axis)>;
  WingAssembly() = default;
  /// @param first  full coordinate of the first displacement; @param first_entry  of the first rotation, -1: right
  /// behind
  WingAssembly(std::shared_ptr<const WingLinkage> linkage, std::vector<Wing> wings, int dimension, int first,
               int first_entry = -1);

  int wingCount() const { return static_cast<int>(wings_.size()); }
  int count() const { return bodies() * (dimension_ + dimension_ * dimension_); }  ///< of full coordinates
  int firstEntry() const { return first_entry_; }                                  ///< of the first rotation
  int rotationCount() const { return bodies(); }
  std::vector<solver::Rotation> rotations() const;
  std::vector<solver::Equation> equations(const OnRing& on_ring) const;
  /// What the elimination kept of the closed chains. @param share  of the vehicle that the problem is; null: nothing
  static std::shared_ptr<const solver::Constraints> chains(const solver::LinearRows& kept, double share);
  std::vector<std::shared_ptr<const solver::Term>> inertia() const;
  /// Friction at the pins, each its own, and stored energy, if the bars have any.
  std::vector<std::shared_ptr<const solver::Term>> pins() const;
  std::vector<std::shared_ptr<const solver::Term>> forces(int wing, const WingForces& of) const;
  /// Joins the crank of a wing with its arm. @param rotation_at_rest  gradient of the arm's rotation by the coordinates
  std::shared_ptr<const HubTerm> hub(int wing, const Eigen::VectorXd& rotation_at_rest, double stiffness) const;
  /// Constrains the crank to the travel instead. @param curve  arm's rotation by the travel
  std::shared_ptr<const solver::Term> travelHub(int wing, const solver::Row& travel, const SmoothCurve& curve,
                                                double stiffness) const;
  /// In words, one sentence each.
  std::vector<std::string> leftOut(const WingForces& of) const;
  double mass() const;  ///< of all wings with their weight [kg]
  /// 1 at the displacements along the axis.
  void markUp(Eigen::VectorXd& up) const;
  /// L times the angle of each rotation where every arm has turned by `crank` [m].
  Eigen::VectorXd turned(double crank) const;
  /// Rotation of a wing from rest by the ring [rad]. @param expected  near which it is looked for
  double wingAngle(const Eigen::VectorXd& y, int wing, double expected) const;
  Turning turning(int wing, WingLinkage::Body body) const;
  /// Full coordinate of the displacement of a body's point at the axle.
  int place(int wing, int body) const { return first_ + dimension_ * (3 * wing + body); }

 private:
  int bodies() const { return 3 * wingCount(); }
  std::vector<Turning> byTheRing(int wing, WingLinkage::Body body) const;
  int entry(int wing, int body) const { return firstEntry() + dimension_ * dimension_ * (3 * wing + body); }
  std::vector<std::pair<int, double>> point(int wing, int body, const Eigen::Vector2d& at, int axis) const;

  std::shared_ptr<const WingLinkage> linkage_;
  std::vector<Wing> wings_;
  int dimension_ = 2, first_ = 0, first_entry_ = 0;
};

}  // namespace snapwing::motion
