#pragma once
/// Simulation of one pulse on a TrialVehicle: the record, the criterion for its end, and the outcome, defined as in the
/// lumped prediction.

#include <functional>
#include <string>
#include <vector>

#include "snapwing/common/error.h"
#include "snapwing/motion/axis_vehicle.h"
#include "snapwing/motion/trial_vehicle.h"
#include "snapwing/vehicle/pulse.h"
#include "snapwing/vehicle/trial_outcome.h"

namespace snapwing::motion {

/// The energy that the scheme added or removed is so large that it may have decided the end mode: smaller steps are
/// needed.
class AccountError : public common::Error {
 public:
  using common::Error::Error;
};

/// Thrust of all rotors under a sequence of demands: first-order lag with separate time constants up and down.
class ThrustHistory {
 public:
  /// @param initial  [N]; @param time_up, time_down  [s] > 0. @throws common::Error
  ThrustHistory(double initial, double time_up, double time_down);
  /// Demands `wanted` [N] from `time` [s] on. @throws common::Error for a time before that of the last demand
  void demand(double time, double wanted);
  double at(double time) const;                  ///< [N]
  double mean(double from, double until) const;  ///< over an interval without a change of demand [N]

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
  double initial_fraction = 0;             ///< [0, 1] before the pulse reaches the motors
  std::vector<vehicle::ThrustLevel> then;  ///< further levels, directly after the pulse, in order
  double final_fraction = 0;               ///< [0, 1] after all levels
  double latency = 0;                      ///< [s] command -> motors
  double max_thrust = 0;                   ///< [N] all rotors
  double time_up = 0, time_down = 0;       ///< [s] time constants of the rotors
  double horizon = 4;                      ///< [s] longest time simulated after the last level
  std::vector<double> changes() const;     ///< [s] times at which the demanded thrust changes, in order
  /// A pulse with a realisation's parameters. @param fraction  [0, 1]; @param duration  [s], 0 .. 60
  /// @param idle  steady thrust at motor idle / full thrust. @throws common::Error
  static AxisTrial of(vehicle::Mode start, double fraction, double duration,
                      const vehicle::VehicleParameters& parameters, double idle, const vehicle::Trial& trial);
};

/// Outcome of a trial, with the definitions of rom::SnapPrediction.
struct AxisOutcome : vehicle::TrialOutcome {
  double largest_imbalance = 0;                        ///< [J] largest |summed imbalance| (StepAccount::imbalance)
  double largest_strain = 0, largest_mean_strain = 0;  ///< [1] of the arms at any time (AxisSample::strain)
  int iterations = 0, factorizations = 0;
};

/// State of a run. A run resumed from a kept one has the same bits as without the interruption.
struct AxisRun {
  MotionState state;
  std::vector<AxisSample> samples;
  AxisOutcome outcome;
  double calm_since = 0;  ///< [s] last time at which the travel was not slow or the thrust not final
  bool begun = false;
};

struct AxisRunHooks {
  /// Called after every step. @return false to stop; the run can be resumed
  std::function<bool(const AxisRun&)> stepped;
  /// Called every `keep_every` steps at a restart point: the next steps depend only on this state.
  std::function<void(const AxisRun&)> keep;
  int keep_every = 200;
};

/// Runs a trial to its end, or continues a stopped one. It ends when for 0.12 s after the last change of demand the
/// thrust is final (within 0.01 of full thrust) and |u'| <= 0.06 m/s, and either the travel is below 0.66 of the
/// barrier's (F), or it is beyond the valley with more than 0.8 of the valley's force (Q); or after the horizon.
/// @return false if stopped by a hook. @throws common::Error if a step fails; AccountError if the summed imbalance
/// exceeds 0.1 of the lower barrier (schemes of second order)
bool runTrial(const TrialVehicle& vehicle, Stepper& stepper, const AxisTrial& trial, AxisRun& run,
              const AxisRunHooks& hooks = {});

}  // namespace snapwing::motion
