#pragma once
/// The wings' linkages in a vehicle, each in the plane and axes of its arm. Three bodies each (crank, wing, rocker)
/// with full coordinates: displacement of the point at the axle, and rotation. Pins are linear equations; those that
/// close the chain are kept as constraints. On a ring that turns in space each bar has a free rotation, and its z axis
/// is kept equal to the ring's.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "snapwing/motion/space_pins.h"
#include "snapwing/motion/wing_linkage.h"
#include "snapwing/motion/wing_terms.h"
#include "snapwing/solver/constraints.h"
#include "snapwing/solver/reduction.h"
#include "snapwing/solver/rotation.h"

namespace snapwing::motion {

/// Further forces on a wing, assumptions of a trial; 0: none.
struct WingForces {
  double rest_stop = 0;  ///< [N m/rad] stiffness of the stop at rest, where the taut film limits the rotation
  double fold_bias = 0;  ///< [N m] constant moment towards folded, of the sewn central fold of the surface
  double fold_stop = 0;  ///< [N m/rad] stiffness of a stop of the crank at the end of the wing's table
  double air = 0;        ///< [N m s2] moment of still air / square of the wing's rate of rotation
};

class WingAssembly {
 public:
  struct Wing {
    bool left = true;
    double weight = 1;    ///< number of wings that it represents, times the problem's share of the vehicle [1] > 0
    double friction = 1;  ///< factor of the layout's friction at its pins [1] >= 0
    /// Rotation of the ring in this wing's plane; none: the ring does not rotate.
    std::optional<Turning> ring = {};
    /// The ring's directions in the axes of this wing's arm, if it turns in space; dimension 3.
    std::optional<Directions> ring_in_space = {};
  };
  /// Displacement of a point of the ring along an axis (0: x, 1: y, 2: z) of a wing's arm: (full coordinate,
  /// coefficient). @param at  position at rest in the linkage's plane [m]
  using OnRing = std::function<std::vector<std::pair<int, double>>(int wing, const Eigen::Vector2d& at, int axis)>;
  WingAssembly() = default;
  /// @param dimension  2 or 3; @param first  full coordinate of the first displacement
  /// @param first_entry  full coordinate of the first rotation's first entry; -1: directly after the displacements
  WingAssembly(std::shared_ptr<const WingLinkage> linkage, std::vector<Wing> wings, int dimension, int first,
               int first_entry = -1);

  int wingCount() const { return static_cast<int>(wings_.size()); }
  int count() const { return bodies() * (dimension_ + dimension_ * dimension_); }  ///< of full coordinates
  int firstEntry() const { return first_entry_; }                                  ///< full coordinate, first rotation
  int rotationCount() const { return bodies(); }
  /// Rotations of all bodies, crank, wing and rocker of each wing in turn: about z, or free in space.
  std::vector<solver::Rotation> rotations() const;
  /// Equations of all pins.
  std::vector<solver::Equation> equations(const OnRing& on_ring) const;
  /// Constraints of the closed chains that elimination kept; null if there are none.
  /// @param share  of the vehicle that the problem represents [1]
  std::shared_ptr<const solver::Constraints> chains(const solver::LinearRows& kept, double share) const;
  /// Inertia terms of all bodies.
  std::vector<std::shared_ptr<const solver::Term>> inertia() const;
  /// Friction terms, one per pin, and the bars' stored energy if they have any.
  std::vector<std::shared_ptr<const solver::Term>> pins() const;
  /// Terms of the forces that are not 0.
  std::vector<std::shared_ptr<const solver::Term>> forces(int wing, const WingForces& of) const;
  /// Couples the crank of a wing to its arm. @param rotation_at_rest  gradient of the arm's rotation with respect to
  /// the nodal displacements [1/m], (dofs x 1); @param stiffness  of one wing [N m]
  /// @param nodes  positions of the nodes at rest from the axle [m], by full coordinates; used in space only
  std::shared_ptr<const Hub> hub(int wing, const Eigen::VectorXd& rotation_at_rest, double stiffness,
                                 const Eigen::VectorXd& nodes = {}) const;
  /// Couples the crank to the travel instead. @param travel  row of u; @param curve  arm's rotation [rad] of u [m]
  /// @param stiffness  of one wing [N m]
  std::shared_ptr<const solver::Term> travelHub(int wing, const solver::Row& travel, const SmoothCurve& curve,
                                                double stiffness) const;
  /// Effects that the model neglects, one phrase each.
  std::vector<std::string> leftOut(const WingForces& of) const;
  double mass() const;  ///< sum of weight times mass of a wing [kg]
  /// Sets the displacements along the thrust axis (y) in a vector of full coordinates to 1.
  void markUp(Eigen::VectorXd& up) const;
  /// L times the rotation vector of each body along its axes [m] at a rotation `crank` of every arm [rad].
  /// @throws common::Error (WingLinkage::at)
  Eigen::VectorXd turned(double crank) const;
  /// Sets the displacements of all bodies at that rotation in a vector of full coordinates, the ring at rest.
  void pose(double crank, Eigen::VectorXd& y) const;
  /// Rotation of a wing from rest, relative to the ring [rad]. @param expected  [rad] within half a turn of the result
  double wingAngle(const Eigen::VectorXd& y, int wing, double expected) const;
  Turning turning(int wing, WingLinkage::Body body) const;
  /// Full coordinate of the x displacement of a body's point at the axle.
  int place(int wing, int body) const { return first_ + dimension_ * (3 * wing + body); }

 private:
  int bodies() const { return 3 * wingCount(); }
  bool inSpace() const { return !wings_.empty() && wings_.front().ring_in_space.has_value(); }
  Directions directions(int wing, WingLinkage::Body body) const;
  std::shared_ptr<const PinAngle> byTheRing(int wing, WingLinkage::Body body) const;
  std::shared_ptr<const PinAngle> between(int wing, WingLinkage::Body body, WingLinkage::Body other) const;
  std::vector<solver::Equation> pinAxes(int wing, const std::string& of) const;
  int entry(int wing, int body) const { return firstEntry() + dimension_ * dimension_ * (3 * wing + body); }
  std::vector<std::pair<int, double>> point(int wing, int body, const Eigen::Vector2d& at, int axis) const;

  std::shared_ptr<const WingLinkage> linkage_;
  std::vector<Wing> wings_;
  int dimension_ = 2, first_ = 0, first_entry_ = 0;
};

}  // namespace snapwing::motion
