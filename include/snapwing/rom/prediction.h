#pragma once
/// What the lumped model says of a pulse.

#include <limits>
#include <string>

#include "snapwing/vehicle/trial_outcome.h"

namespace snapwing::rom {

/// Answer of the lumped model; the members follow msg/SnapPrediction.msg. docs/reduced_model.md defines the margin.
struct SnapPrediction : vehicle::TrialOutcome {
  std::string rung = "lumped";
  double energy_margin = std::numeric_limits<double>::quiet_NaN();  ///< [1] > 0: the switch happens and holds
  double force_error = std::numeric_limits<double>::quiet_NaN();    ///< [N]
  bool out_of_table = false;
  double compute_seconds = 0;  ///< wall time, filled by callers that measure it
};

}  // namespace snapwing::rom
