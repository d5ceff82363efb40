#pragma once
/// The planner's search: scan, NLopt refinement, check with fresh vehicles. Private to the layer.

#include <cmath>
#include <functional>
#include <vector>

#include "box_ensemble.h"

namespace snapwing::planning {

/// Value `index` of `count` from low to high, both included.
inline double gridValue(double low, double high, int index, int count) {
  return count > 1 ? low + (high - low) * index / (count - 1) : low;
}

/// A pulse that may be returned to, and how the first vehicles of the ensemble fare with it.
struct Candidate {
  vehicle::Pulse pulse;
  BoxEnsembleOutcome known;
};

/// One search: the ensemble grows by what the check finds.
class PulseSearch {
 public:
  PulseSearch(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table, const rom::VehicleCurves& curves,
              const PlannerSettings& settings, vehicle::Mode start, const vehicle::Trial& trial,
              std::function<bool()> cancelled);

  /// Coarse scan; keeps its best pulses.
  void scan();
  /// Best of the pulses kept, by all realisations known so far.
  vehicle::Pulse bestCandidate();
  /// NLopt from a pulse.
  vehicle::Pulse refine(const vehicle::Pulse& from);
  /// Effects of single parameters; adds the corners of those that matter most to both ensembles.
  void addCorners(const vehicle::Pulse& pulse);
  std::vector<ParameterInfluence> influences(const vehicle::Pulse& pulse, double* vertex_margin);
  /// Full check with fresh realisations.
  BoxEnsembleOutcome check(const vehicle::Pulse& pulse);
  /// Takes the worst of a check into the search.
  void learn(const vehicle::Pulse& pulse, const BoxEnsembleOutcome& checked);

  /// What is maximised: worst margin (of the share that must switch), capped where there is enough of it, less the
  /// price of the impulse.
  double value(const vehicle::Pulse& pulse, const BoxEnsembleOutcome& outcome) const {
    const double margin = outcome.reached(settings_.required_share);
    if (!(margin > 0)) return margin;
    return std::min(margin, settings_.enough_margin) - settings_.impulse_price * pulse.throttle * pulse.duration;
  }
  bool cancelled() const { return cancelled_ && cancelled_(); }
  const BoxEnsemble& checkedEnsemble() const { return checked_; }
  int evaluations() const { return evaluations_; }
  long predictions() const { return predictions_; }

 private:
  PlannerSettings settings_;
  vehicle::Mode start_;
  vehicle::Trial trial_;
  std::function<bool()> cancelled_;
  BoxEnsemble ensemble_, checked_;
  std::vector<Candidate> candidates_;
  int evaluations_ = 0;
  long predictions_ = 0;
};

}  // namespace snapwing::planning
