#pragma once
/// Serves goals of kind WING of the action optimize_design, and publishes wings as WingGeometry, latched.

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <snapwing/WingGeometry.h>

#include <string>

#include "design_job.h"
#include "snapwing/design/wing/wing_outcome.h"
#include "snapwing/vehicle/vehicle.h"

namespace snapwing::nodes {

/// @param table_file  where the table of this layout is
WingGeometry wingMessage(const design::WingLayout& layout, const std::string& table_file);

class WingDesigner {
 public:
  /// Publishes the vehicle's own wing, if it names one. @param relative  where wing_geometry and designed/wing_geometry
  /// are advertised; @param frame  of both. @throws common::Error if the vehicle's wing cannot be read
  WingDesigner(ros::NodeHandle& relative, const vehicle::Vehicle& vehicle, std::string frame);

  /// Takes the stored design of the same inputs, or designs again on the bars that the settings name, checked by
  /// elastic ones.
  /// @throws common::Error for bad input
  OptimizeDesignResult run(const DesignJob& job);

 private:
  void publish(const ros::Publisher& to, const design::WingLayout& layout, const std::string& table_file);

  std::string frame_;
  ros::Publisher geometry_, designed_;
};

}  // namespace snapwing::nodes
