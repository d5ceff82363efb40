#pragma once
/// A simulated trial as a bag for rviz, rqt and Foxglove: what `snapwing trial -o FOLDER` left, with time from 1 s on.
///
/// Topics: /tf (map -> base_link -> housing), /joint_states (travel, arm, wing_left, wing_right), /mode_state (the side
/// of the barrier), /truth in every row of the series; /markers at MARKER_RATE.

#include <string>
#include <vector>

#include "snapwing/vehicle/mode.h"

namespace snapwing::nodes {

constexpr double BAG_BEGIN = 1.0;     ///< [s] stamp of the trial's time 0: a bag knows no time 0
constexpr double MARKER_RATE = 50.0;  ///< [Hz]

/// Rows of series.csv, and what summary.json says of them. [s], [m], [m/s], [rad], [N]
struct TrialSeries {
  std::string name, vehicle_file;
  bool wings = false;  ///< they acted
  double barrier = 0;  ///< [m] travel; NaN: the trial's summary has none, and the table's counts
  std::vector<double> time, travel, travel_rate, arm_rotation, wing_left, wing_right, ring_position, ring_speed, thrust;
};

/// @param folder  of a trial. @throws common::FileError naming the file and what is wrong in it
TrialSeries readTrialSeries(const std::string& folder);

/// Writes FOLDER/run.bag, whole or not at all. @return its path. @throws common::Error
std::string writeTrialBag(const std::string& folder);

}  // namespace snapwing::nodes
