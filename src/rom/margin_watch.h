#pragma once
/// Watches a trajectory step by step: extremes of travel, crossings of the barrier, and the energy margin. Private to
/// the layer; docs/reduced_model.md defines the margin.

#include "snapwing/rom/loaded_basins.h"
#include "snapwing/rom/lumped_model.h"

namespace snapwing::rom {

class MarginWatch {
 public:
  MarginWatch(const LumpedModel& model, const vehicle::Trial& trial, vehicle::Mode start, const LumpedState& first);

  /// Takes the step from the last state seen to `next`.
  void add(const LumpedState& next);

  /// Is the relative motion calm in a basin that holds, now and at the terminal speed under this demand?
  bool settled(double demand) const;

  /// Fills end mode, times, travels and margin. @param settled what settled() said at the end
  void finish(bool settled, SnapPrediction* prediction) const;

 private:
  double barrierOf(vehicle::Mode side) const;
  /// Energy of the relative motion [J].
  double kinetic(double travel, double rate) const;
  /// @param relative_rate  [m/s] of the travel against the loaded barrier, which moves with the load
  void enter(vehicle::Mode side, double travel, double relative_rate, const RelativeLoad& load);
  /// Takes the next distance from the loaded barrier; where the one before was the closest, its clearance counts.
  void approach(double distance);

  const LumpedModel& model_;
  const vehicle::Trial& trial_;
  const Equilibria& equilibria_;
  LoadedBasins basins_;
  vehicle::Mode target_;
  LumpedState last_;
  RelativeLoad last_load_;
  LoadedBarrier last_barrier_;
  vehicle::Mode side_;  ///< of the loaded barrier
  double peak_, least_, peak_speed_;
  double crossing_time_;                     ///< [s] last crossing of the unloaded barrier; NaN = none
  double entry_;                             ///< [1] energy by which the present side was entered
  double hold_;                              ///< [1] smallest clearance at closest approaches since then
  double earlier_distance_, last_distance_;  ///< [m] from the loaded barrier at the two states seen last; -INF = none
};

}  // namespace snapwing::rom
