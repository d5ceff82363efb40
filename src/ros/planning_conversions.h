#pragma once
/// Predictions and plans of the core -> messages, and the parameters that predictor and planner share.

#include <snapwing/SnapPrediction.h>
#include <snapwing/TransitionPlan.h>

#include "params.h"
#include "snapwing/planning/pulse_planner.h"
#include "snapwing/vehicle/trial.h"

namespace snapwing::nodes {

SnapPrediction toMessage(const rom::SnapPrediction& prediction);
/// The header is left empty.
TransitionPlan toMessage(const planning::TransitionPlan& plan);

/// Keys `mount` (free, boom, held), `wings` (auto, on, off), `gravity` [m/s2] and `horizon` [s]. @throws common::Error
vehicle::Trial readTrial(Params& params, const vehicle::Vehicle& vehicle);

}  // namespace snapwing::nodes
