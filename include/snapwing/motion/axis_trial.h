#pragma once
/// One pulse on a vehicle in time (trial_vehicle.h): what is recorded, when it has ended, and the answer in the words
/// of the lumped prediction.

#include <functional>
#include <string>
#include <vector>

#include "snapwing/common/error.h"
#include "snapwing/motion/axis_vehicle.h"
#include "snapwing/motion/trial_vehicle.h"
#include "snapwing/vehicle/pulse.h"
#include "snapwing/vehicle/trial_outcome.h"

namespace snapwing::motion {

/// What a scheme fed or ate could have decided the end mode: smaller steps are needed.
class AccountError : public common::Error {
 public:
  using common::Error::Error;
};

/// Thrust of all rotors under a sequence of demands: first-order lag, with one constant up and another down.
class ThrustHistory {
 public:
  /// @param initial  [N]; @param time_up, time_down  [s] > 0
  ThrustHistory(double initial, double time_up, double time_down);
  /// From `time` on (not before the last one) `wanted` newtons.
  void demand(double time, double wanted);
  double at(double time) const;                  ///< [N]
  double mean(double from, double until) const;  ///< over a time without a change of demand [N]

 private:
  struct Piece {
    double time, wanted, thrust;
  };
  const Piece& pieceAt(double time) const;
  std::vector<Piece> pieces_;
  double up_, down_;
};

struct AxisTrial {
  vehicle::Mode start = vehicle::Mode::FIXED_WING;
  double fraction = 0;                     ///< steady thrust of the pulse / full thrust, [0, 1]
  double duration = 0;                     ///< of the command [s] >= 0
  double initial_fraction = 0;             ///< before the pulse reaches the motors
  std::vector<vehicle::ThrustLevel> then;  ///< one after the other, right behind the pulse
  double final_fraction = 0;               ///< after all of them
  double latency = 0;                      ///< [s] command -> motors
  double max_thrust = 0;                   ///< [N] all rotors
  double time_up = 0, time_down = 0;       ///< [s]
  double horizon = 4;                      ///< [s] longest time watched after the last level
  std::vector<double> changes() const;     ///< [s] when another thrust is asked of the motors, in order
  /// A pulse on realised parameters. @param idle  steady thrust at motor idle / full thrust
  static AxisTrial of(vehicle::Mode start, double fraction, double duration,
                      const vehicle::VehicleParameters& parameters, double idle, const vehicle::Trial& trial);
};

/// The members of rom::SnapPrediction that a solid has, by the same definitions.
struct AxisOutcome : vehicle::TrialOutcome {
  double largest_imbalance = 0;  ///< [J] of the summed account: what the scheme fed or ate
  double largest_strain = 0;     ///< [1] of the arms at any time
  int iterations = 0, factorizations = 0;
};

/// What a run is resumed from: with the same bits as without the interruption.
struct AxisRun {
  MotionState state;
  std::vector<AxisSample> samples;
  AxisOutcome outcome;
  double calm_since = 0;  ///< [s] since when the travel has been slow
  bool begun = false;
};

struct AxisRunHooks {
  /// After every step. @return false to stop; the run can be resumed
  std::function<bool(const AxisRun&)> stepped;
  /// A state worth keeping: what follows depends on it alone. Called every `keep_every` steps.
  std::function<void(const AxisRun&)> keep;
  int keep_every = 200;
};

/// Runs a trial to its end, or goes on with one that was stopped. Ended: thrust idle, |u'| < .06 m/s for .12 s, and in
/// F the travel below two thirds of the barrier's, in Q beyond the valley with more than .8 of its force.
/// @return false if stopped. @throws common::Error if a step fails
bool runTrial(const TrialVehicle& vehicle, Stepper& stepper, const AxisTrial& trial, AxisRun& run,
              const AxisRunHooks& hooks = {});

}  // namespace snapwing::motion
