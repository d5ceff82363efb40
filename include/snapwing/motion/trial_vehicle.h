#pragma once
/// What a trial needs to know of a vehicle in time, however many degrees of freedom it has.

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

/// One row a step; all of the whole vehicle.
struct AxisSample {
  double time = 0;                                             ///< [s]
  double ring_position = 0, ring_speed = 0, centre_speed = 0;  ///< [m], [m/s]
  double travel = 0, travel_rate = 0;                          ///< [m], [m/s]
  double arm_rotation = 0;                                     ///< [rad]
  /// Rotations of the wings from rest [rad], and the largest angle between a crank and its arm; NaN without wings.
  double wing_left = std::numeric_limits<double>::quiet_NaN(), wing_right = wing_left, hub_twist = wing_left;
  /// In six degrees of freedom, else NaN: angle of the thrust axis to that of the start and of the housing to the ring
  /// [rad], how far the ring has drifted across that axis [m], rate of its turning [rad/s], how far the centre is off
  /// the ring's axis [m].
  double tilt = wing_left, housing_tilt = wing_left, drift = wing_left, turn_rate = wing_left, centre_off = wing_left;
  double thrust = 0;                                                  ///< [N]
  double kinetic = 0, stored = 0, work = 0, loss = 0, imbalance = 0;  ///< [J]; the last three summed from the start
  double relative_kinetic = wing_left;  ///< [J] less that of the common speed: of the travel; NaN in six degrees
  double strain = 0;                    ///< [1] largest principal one of the arms (mpm::Discretisation::largestStrain)
  double step = 0;                      ///< [s]
  double min_det_f = 1;
  int iterations = 0;
};

/// The place nearest to `before` of those that differ by whole turns from `now`; a turn of 0 is none.
inline double onward(double before, double now, double turn) {
  return turn > 0 ? now + turn * std::round((before - now) / turn) : now;
}

class TrialVehicle {
 public:
  virtual ~TrialVehicle() = default;
  virtual std::shared_ptr<const solver::TermProblem> problem() const = 0;
  /// Energies of the problem / those of the vehicle [1].
  virtual double shareOfVehicle() const = 0;
  /// Of the arms along the thrust axis; forces of the problem that it was traced on.
  virtual const StaticCurve& curve() const = 0;
  /// Of the unloaded vehicle: the lower of both barriers [J], the force in the valley [N].
  virtual double lowerBarrier() const = 0;
  virtual double valleyForce() const = 0;
  /// The curve with the arm's inertia as a table of one arm, without provenance.
  virtual vehicle::ForceTable staticTable() const = 0;
  virtual double armMass() const = 0;                             ///< of all arms [kg]
  virtual const WingLinkage* linkage() const { return nullptr; }  ///< null without wings

  /// At rest in the equilibrium of a mode under the trial's loads before the pulse, moving with its initial speed.
  /// @param thrust  [N] of the vehicle; @param held  false if the mode is no equilibrium under these loads
  virtual MotionState start(vehicle::Mode mode, double thrust, bool* held = nullptr) const = 0;
  /// Controls of the problem in a step. @param thrust  mean of the vehicle over it [N]
  virtual Eigen::VectorXd controls(double from, double h, double thrust) const = 0;
  /// All of a row that the state tells; energies of the whole vehicle.
  virtual AxisSample sample(const MotionState& s) const = 0;
  /// [m] by which a sample's ring_position may be off, any number of times: what a boom's end goes in a turn; 0: exact
  virtual double turnLength() const { return 0; }
  /// What the scheme CORRECTED_MIDPOINT must leave alone.
  virtual RigidMotions rigidMotions() const = 0;
  /// Momentum along the axis / mass of all that moves [m/s].
  virtual double commonSpeed(const MotionState& s, const Stepper& stepper) const = 0;
  /// Kinetic energy of the vehicle in the frame of that speed, or of the held ring [J]; NaN: not told.
  virtual double relativeKinetic(const MotionState& /*s*/, const Stepper& /*stepper*/) const {
    return std::numeric_limits<double>::quiet_NaN();
  }
  /// Deformed cells as VTU text.
  virtual std::string vtu(const MotionState& s) const = 0;
  /// What this rung keeps beyond the simplest one, and what it leaves out of the trial, one sentence each.
  virtual std::vector<std::string> kept() const { return {}; }
  virtual std::vector<std::string> leftOut() const = 0;
  int freeCount() const { return problem()->freeCount(); }
  virtual int cellCount() const = 0;
};

}  // namespace snapwing::motion
