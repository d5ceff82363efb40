#pragma once
/// Serves goals of kind ARM of the action optimize_design, and publishes the arm that came out, latched.

#include <ros/node_handle.h>
#include <ros/publisher.h>

#include <string>

#include "design_job.h"
#include "snapwing/design/arm/arm_outcome.h"

namespace snapwing::nodes {

class ArmDesigner {
 public:
  /// @param relative  where designed/arm_geometry and designed/force_curve are advertised; @param frame  of both
  ArmDesigner(ros::NodeHandle& relative, std::string frame);

  /// Takes the stored design of the same inputs, or resumes a preempted goal, or starts one.
  /// @throws common::Error for bad input
  OptimizeDesignResult run(const DesignJob& job);

 private:
  void publish(const design::ArmDesignSettings& settings, const design::ArmOutcome& outcome);

  std::string frame_;
  ros::Publisher geometry_, curve_;
};

}  // namespace snapwing::nodes
