#pragma once
/// Finds the thrust pulse (throttle, duration) that switches the mode for every vehicle in the uncertainty box, with
/// the largest worst-case energy margin, or says why there is none. Search: coarse deterministic scan, then NLopt
/// (LN_SBPLX) from the best of it; then a check with a fresh, larger set of realisations.

#include <functional>
#include <string>
#include <vector>

#include "snapwing/rom/lumped_model.h"
#include "snapwing/rom/vehicle_curves.h"
#include "snapwing/vehicle/force_table.h"
#include "snapwing/vehicle/pulse.h"
#include "snapwing/vehicle/trial.h"
#include "snapwing/vehicle/vehicle.h"
#include "snapwing/vehicle/vehicle_parameters.h"

namespace snapwing::planning {

struct PlannerSettings {
  double throttle_min = 0.10;  ///< [1] stick travel
  double throttle_max = 1.0;   ///< [1]
  double duration_min = 0.10;  ///< [s] five frames of a 50 Hz stream
  double duration_max = 1.2;   ///< [s]
  /// Behind each pulse that switches to Q, before throttle low or the trial's final thrust; 0, 0 = none. Nothing holds
  /// F: it is reached by a cut.
  double hold_throttle = 0;  ///< [1] stick travel
  double hold_duration = 0;  ///< [s]
  int scan_throttles = 15;   ///< coarse scan's grid
  int scan_durations = 15;
  /// Realisations during the search, beside the nominal one and corners: with these whole blocks of the ensemble.
  int search_samples = 63;
  int verify_samples = 512;       ///< fresh realisations for the final check
  int corner_parameters = 4;      ///< every corner of this many parameters that matter most is checked as well, 0 .. 8
  int refine_evaluations = 40;    ///< of NLopt, at most
  double required_margin = 0.05;  ///< [1] worst margin that a plan must have, in units of the barrier
  double enough_margin = 0.20;    ///< [1] worst margin beyond which a weaker and shorter pulse is preferred
  double required_share = 1.0;    ///< [1] share of the realisations that must end in the target mode
  /// [1/s] margin that one second of full throttle must bring: prefers weak and short pulses at equal margins
  double impulse_price = 0.05;
  /// Uncertain pulse length in frames of the radio: start and end fall anywhere within a frame
  double frame_jitter = 1.0;
  bool allow_out_of_table = false;  ///< accept pulses that stretch u beyond the table or the upper limit of travel
  int threads = 2;                  ///< the result is the same for any number
  rom::LumpedSettings model{1e-3};  ///< of predictions one at a time: of the worst vehicles that an ensemble found
  double model_step = 8e-3;         ///< [s] largest step of the ensemble in the search; in the check half of it
  void validate() const;            ///< @throws common::Error naming the member
  /// A pulse with the hold behind it, if there is one for this direction.
  vehicle::Pulse pulse(vehicle::Mode start, double throttle, double duration) const {
    if (start != vehicle::Mode::FIXED_WING) return {throttle, duration};
    return {throttle, duration, hold_throttle, hold_duration};
  }
};

/// Effect of one uncertain number on the margin of a pulse, all others nominal.
struct ParameterInfluence {
  std::string name;
  double low_margin = 0;   ///< [1] margin with the number at its low end
  double high_margin = 0;  ///< [1] at its high end
};

/// Members follow msg/TransitionPlan.msg.
struct TransitionPlan {
  vehicle::Mode start_mode = vehicle::Mode::UNKNOWN;
  vehicle::Mode target_mode = vehicle::Mode::UNKNOWN;
  bool accepted = false;
  std::string reason;  ///< empty if accepted
  vehicle::Pulse pulse;
  double thrust_fraction = 0;  ///< nominal
  double worst_margin = 0;     ///< [1]
  double share_switched = 0;   ///< [1]
  int realisations = 0;
  double compute_seconds = 0;  ///< filled by callers that measure it
  rom::SnapPrediction nominal;
  rom::SnapPrediction worst;
  vehicle::VehicleParameters worst_parameters;
  std::vector<double> worst_coordinates;  ///< in [-1, 1], one per plannerCoordinateNames()
  /// Parameters by their effect on the margin at this pulse, largest first.
  std::vector<ParameterInfluence> influences;
  /// [1] margin of the one vertex of the box where each parameter takes the end that hurts: far less probable than
  /// any realisation checked, hence for information only
  double vertex_margin = 0;
  int evaluations = 0;   ///< pulses tried
  long predictions = 0;  ///< trials integrated
};

/// A vehicle of the box and what a pulse leaves it.
struct RankedVehicle {
  std::vector<double> coordinates;  ///< in [-1, 1], one per plannerCoordinateNames()
  double margin = 0;                ///< [1]
};

/// One cell of the outcome map.
struct OutcomeCell {
  double throttle = 0, duration = 0;
  double share = 0;         ///< [1] of the realisations that end in the target
  double worst_margin = 0;  ///< [1]
};

struct OutcomeMap {
  vehicle::Mode start_mode = vehicle::Mode::UNKNOWN;
  std::vector<double> throttles, durations;
  std::vector<OutcomeCell> cells;  ///< row by row: cells[i * durations.size() + j] = throttle i, duration j
  int realisations = 0;
};

/// Immutable; plan() and map() may run in several threads.
class PulsePlanner {
 public:
  /// @param wing  the vehicle's wings, if any
  /// @throws common::Error for bad settings or tables
  PulsePlanner(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table, const PlannerSettings& settings = {},
               const std::optional<vehicle::WingTable>& wing = {});

  /// @param start   mode that the vehicle is in
  /// @param target  mode wanted; equal to start, or a table that is not bistable: refused with a reason
  /// @param cancelled  polled now and then; true ends the search with a refusal "cancelled"
  TransitionPlan plan(vehicle::Mode start, vehicle::Mode target, const vehicle::Trial& trial,
                      const std::function<bool()>& cancelled = {}) const;
  TransitionPlan plan(vehicle::Mode start, const vehicle::Trial& trial) const;

  /// Outcome over a grid of pulses, over the search's realisations.
  /// @param progress  gets the pulses done and their number, from any thread, one call at a time
  OutcomeMap map(vehicle::Mode start, const vehicle::Trial& trial, int throttles, int durations,
                 const std::function<void(int done, int all)>& progress = {}) const;

  /// The vehicles of the check, corners included, that a pulse leaves the least margin, least first.
  std::vector<RankedVehicle> weakest(vehicle::Mode start, const vehicle::Pulse& pulse, const vehicle::Trial& trial,
                                     int count) const;

  const PlannerSettings& settings() const { return settings_; }

 private:
  vehicle::Vehicle vehicle_;
  vehicle::ForceTable table_;
  PlannerSettings settings_;
  rom::VehicleCurves curves_;
};

/// A pulse as a vehicle's motors see it. @param length_error  the vehicle's last coordinate, in [-1, 1]
vehicle::Pulse receivedPulse(const vehicle::Pulse& pulse, const PlannerSettings& settings, const vehicle::Radio& radio,
                             double length_error);

/// Names of the planner's coordinates: vehicle::uncertainNames() and the pulse's length.
std::vector<std::string> plannerCoordinateNames();

}  // namespace snapwing::planning
