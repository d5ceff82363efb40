#pragma once
/// Finds the thrust pulse (throttle, duration) that switches the mode for every vehicle in the uncertainty box, with
/// the largest worst-case energy margin, or says why there is none. Search: coarse deterministic scan, then NLopt
/// (LN_SBPLX) from the best of it; then a check with a fresh, larger set of realisations.

#include <functional>
#include <string>
#include <vector>

#include "snapwing/common/force_table.h"
#include "snapwing/common/pulse.h"
#include "snapwing/common/vehicle.h"
#include "snapwing/common/vehicle_parameters.h"
#include "snapwing/rom/lumped_model.h"
#include "snapwing/rom/trial.h"

namespace snapwing::planning {

struct PlannerSettings {
  double throttle_min = 0.10;  ///< [1] stick travel
  double throttle_max = 1.0;   ///< [1]
  double duration_min = 0.06;  ///< [s]
  double duration_max = 1.2;   ///< [s]
  int scan_throttles = 14;     ///< coarse scan's grid
  int scan_durations = 14;
  int search_samples = 64;        ///< realisations during the search, beside the corners
  int verify_samples = 512;       ///< fresh realisations for the final check
  int refine_evaluations = 60;    ///< of NLopt, at most
  double required_margin = 0.05;  ///< [1] worst margin that a plan must have, in units of the barrier
  double required_share = 1.0;    ///< [1] share of the realisations that must end in the target mode
  /// [1/s] margin given up for a pulse that is one second shorter: prefers short pulses when margins tie
  double duration_price = 0.02;
  int threads = 2;  ///< the result is the same for any number
  rom::LumpedSettings model;
  void validate() const;  ///< @throws common::Error naming the member
};

/// Members follow msg/TransitionPlan.msg.
struct TransitionPlan {
  common::Mode start_mode = common::Mode::UNKNOWN;
  common::Mode target_mode = common::Mode::UNKNOWN;
  bool accepted = false;
  std::string reason;  ///< empty if accepted
  common::Pulse pulse;
  double thrust_fraction = 0;  ///< nominal
  double worst_margin = 0;     ///< [1]
  double share_switched = 0;   ///< [1]
  int realisations = 0;
  double compute_seconds = 0;
  rom::SnapPrediction nominal;
  rom::SnapPrediction worst;
  common::VehicleParameters worst_parameters;
  std::vector<double> worst_coordinates;  ///< in [-1, 1], one per common::uncertainNames()
  int evaluations = 0;                    ///< pulses tried
  long predictions = 0;                   ///< trials integrated
};

/// One cell of the outcome map.
struct OutcomeCell {
  double throttle = 0, duration = 0;
  double share = 0;         ///< [1] of the realisations that end in the target
  double worst_margin = 0;  ///< [1]
};

struct OutcomeMap {
  common::Mode start_mode = common::Mode::UNKNOWN;
  std::vector<double> throttles, durations;
  std::vector<OutcomeCell> cells;  ///< row by row: cells[i * durations.size() + j] = throttle i, duration j
  int realisations = 0;
};

/// Immutable; plan() and map() may run in several threads.
class PulsePlanner {
 public:
  /// @throws common::Error for bad settings or table
  PulsePlanner(const common::Vehicle& vehicle, const common::ForceTable& table, const PlannerSettings& settings = {});

  /// @param start   mode that the vehicle is in
  /// @param target  mode wanted; equal to start, or a table that is not bistable: refused with a reason
  /// @param cancelled  polled now and then; true ends the search with a refusal "cancelled"
  TransitionPlan plan(common::Mode start, common::Mode target, const rom::Trial& trial,
                      const std::function<bool()>& cancelled = {}) const;
  TransitionPlan plan(common::Mode start, const rom::Trial& trial) const;

  /// Outcome over a grid of pulses, over the search's realisations.
  OutcomeMap map(common::Mode start, const rom::Trial& trial, int throttles, int durations) const;

  const PlannerSettings& settings() const { return settings_; }

 private:
  common::Vehicle vehicle_;
  common::ForceTable table_;
  PlannerSettings settings_;
  std::vector<std::vector<double>> search_points_, verify_points_;  ///< coordinates of the box
};

/// Deterministic points of [-1, 1]^dimension: the centre, then corners that matter, then a shifted Halton sequence.
/// @param first  index of the first Halton point: disjoint ranges give fresh points
std::vector<std::vector<double>> boxPoints(int dimension, int halton_points, int first);

}  // namespace snapwing::planning
