#pragma once
/// Interface between a trial and a model of the vehicle's motion, along the axis or in six degrees of freedom.

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "snapwing/motion/static_curve.h"
#include "snapwing/motion/stepper.h"
#include "snapwing/motion/wing_linkage.h"
#include "snapwing/vehicle/force_table.h"
#include "snapwing/vehicle/mode.h"

namespace snapwing::motion {

/// Record of one step; energies of the whole vehicle.
struct AxisSample {
  double time = 0;                                             ///< [s]
  double ring_position = 0, ring_speed = 0, centre_speed = 0;  ///< along the thrust axis [m], [m/s]
  double travel = 0, travel_rate = 0;                          ///< [m], [m/s]
  double arm_rotation = 0;                                     ///< of the left arm about its axle [rad]
  /// Rotations of the wings from rest, and the largest angle between a crank and its arm [rad]; NaN without wings.
  double wing_left = std::numeric_limits<double>::quiet_NaN(), wing_right = wing_left, hub_twist = wing_left;
  /// In six degrees of freedom, else NaN: angle of the thrust axis to that at the start, and rotation of the housing
  /// relative to the ring [rad]; displacement of the ring across the axis of the start [m]; angular speed of the ring
  /// [rad/s]; distance of the centre from the ring's axis [m].
  double tilt = wing_left, housing_tilt = wing_left, drift = wing_left, turn_rate = wing_left, centre_off = wing_left;
  double thrust = 0;                                                  ///< [N]
  double kinetic = 0, stored = 0, work = 0, loss = 0, imbalance = 0;  ///< [J]; the last three summed from the start
  double relative_kinetic = wing_left;  ///< [J] TrialVehicle::relativeKinetic; NaN in six degrees of freedom
  /// [1] of the arms: largest strain of a cell (mpm::cellStrains), which depends on the cells' size, and
  /// largest mean over the material within mpm::STRAIN_RADIUS of a point, which converges.
  double strain = 0, mean_strain = 0;
  double step = 0;       ///< length of the step [s]
  double min_det_f = 1;  ///< smallest over the particles [1]
  int iterations = 0;
};

/// `now` plus the multiple of `turn` that brings it nearest to `before`; `now` if `turn` is 0. [m]
inline double onward(double before, double now, double turn) {
  return turn > 0 ? now + turn * std::round((before - now) / turn) : now;
}

class TrialVehicle {
 public:
  virtual ~TrialVehicle() = default;
  virtual std::shared_ptr<const solver::TermProblem> problem() const = 0;
  /// Energies of the problem / those of the vehicle [1].
  virtual double shareOfVehicle() const = 0;
  /// Static curve of the arms along the thrust axis; its forces are those of the traced scene.
  virtual const StaticCurve& curve() const = 0;
  /// Of the unloaded vehicle: the lower one of both barriers [J], the force in the valley [N].
  virtual double lowerBarrier() const = 0;
  virtual double valleyForce() const = 0;
  /// The curve with the arm's inertia as a table of one arm, without provenance.
  virtual vehicle::ForceTable staticTable() const = 0;
  virtual double armMass() const = 0;                             ///< of all arms [kg]
  virtual const WingLinkage* linkage() const { return nullptr; }  ///< null without wings

  /// State in the equilibrium of a mode under the trial's loads before the pulse, moving with its initial speed.
  /// @param thrust  [N] of the vehicle; @param held  out: false if the mode is no equilibrium under these loads
  /// @throws common::Error for an unknown mode, or if a step of the search fails
  virtual MotionState start(vehicle::Mode mode, double thrust, bool* held = nullptr) const = 0;
  /// Controls of the problem in a step from `from` to `from + h` [s]. @param thrust  mean of the vehicle over it [N]
  virtual Eigen::VectorXd controls(double from, double h, double thrust) const = 0;
  /// Record of a state, without the members that belong to a step.
  virtual AxisSample sample(const MotionState& s) const = 0;
  /// [m] A sample's ring_position is known up to multiples of this: circumference of a boom's path; 0: unique.
  virtual double turnLength() const { return 0; }
  /// Rigid motions for the scheme CORRECTED_MIDPOINT (Stepper).
  virtual RigidMotions rigidMotions() const = 0;
  /// Momentum along the thrust axis / mass of all moving parts [m/s].
  virtual double commonSpeed(const MotionState& s, const Stepper& stepper) const = 0;
  /// Kinetic energy of the vehicle in the frame of that speed, or of the held ring [J]; NaN: not available.
  virtual double relativeKinetic(const MotionState& /*s*/, const Stepper& /*stepper*/) const {
    return std::numeric_limits<double>::quiet_NaN();
  }
  /// Deformed cells as VTU text.
  virtual std::string vtu(const MotionState& s) const = 0;
  /// Effects that this model includes beyond the one along the axis, and effects that it neglects, one phrase each.
  virtual std::vector<std::string> kept() const { return {}; }
  virtual std::vector<std::string> leftOut() const = 0;
  int freeCount() const { return problem()->freeCount(); }
  virtual int cellCount() const = 0;
};

}  // namespace snapwing::motion
