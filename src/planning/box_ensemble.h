#pragma once
/// Vehicles, one for each point of the uncertainty box, on which pulses are tried. Private to the layer.

#include <cmath>
#include <vector>

#include "snapwing/planning/pulse_planner.h"
#include "snapwing/planning/uncertainty_points.h"
#include "snapwing/rom/ensemble.h"
#include "snapwing/rom/vehicle_curves.h"
#include "snapwing/vehicle/pulse.h"

namespace snapwing::planning {

/// Outcome of one pulse over an ensemble.
struct BoxEnsembleOutcome {
  double worst = INFINITY;  ///< smallest margin among those tried
  int worst_index = 0;      ///< who had it
  int switched = 0;         ///< how many ended in the target mode
  int tried = 0;
  std::vector<double> margins;  ///< of those tried, in order
  /// Margin that the wanted share of the vehicles reaches; the worst if all must.
  double reached(double share) const;
};

class BoxEnsemble {
 public:
  /// @param table  of one arm; @param curves  made of it and the wings; @param step  of the ensemble [s]
  BoxEnsemble(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table, const rom::VehicleCurves& curves,
              const PlannerSettings& settings, double step);

  /// An ensemble of the same kind without vehicles.
  BoxEnsemble emptyCopy() const { return BoxEnsemble(vehicle_, table_, curves_, settings_, step_); }

  /// Adds a vehicle. Its last coordinate is the pulse's length error, in frame_jitter frames.
  void add(const BoxPoint& point);
  void add(const std::vector<BoxPoint>& points);

  int size() const { return static_cast<int>(points_.size()); }
  const BoxPoint& point(int index) const { return points_[index]; }
  rom::LumpedModel model(int index) const;
  const std::vector<BoxPoint>& points() const { return points_; }

  /// The pulse as this vehicle's motors see it.
  vehicle::Pulse received(int index, const vehicle::Pulse& pulse) const;
  rom::SnapPrediction predict(int index, vehicle::Mode start, const vehicle::Pulse& pulse,
                              const vehicle::Trial& trial) const;
  /// Margin that counts: the model's, or less if the travel leaves what is known. [1], [m]
  double margin(double energy_margin, double peak_travel) const;

  /// Tries a pulse on all vehicles, in order; if all must switch, gives up after a block, side by side, whose worst is
  /// below `give_up`.
  /// @param known  outcome of the same pulse and trial for the first of them, which are not tried again
  BoxEnsembleOutcome tryPulse(vehicle::Mode start, const vehicle::Pulse& pulse, const vehicle::Trial& trial,
                              double give_up, int threads, const BoxEnsembleOutcome& known = {}) const;

 private:
  vehicle::Vehicle vehicle_;
  vehicle::ForceTable table_;
  rom::VehicleCurves curves_;
  PlannerSettings settings_;
  double step_;
  rom::Ensemble ensemble_;
  std::vector<BoxPoint> points_;
  std::vector<vehicle::VehicleParameters> parameters_;
};

}  // namespace snapwing::planning
