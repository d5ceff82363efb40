/// design_node: publishes, once and latched, the vehicle's arm, the force-displacement curve that was computed for it
/// and its wing, and warns if the curve was computed from other inputs than those now on disk. Action optimize_design:
/// designs a part from a settings file, or finds the stored result of the same inputs.

#include <actionlib/server/simple_action_server.h>
#include <ros/console.h>
#include <ros/publisher.h>
#include <snapwing/OptimizeDesignAction.h>

#include <cstdlib>
#include <filesystem>
#include <limits>

#include "arm_designer.h"
#include "conversions.h"
#include "design_job.h"
#include "node_main.h"
#include "params.h"
#include "snapwing/common/error.h"
#include "snapwing/vehicle/force_table.h"
#include "snapwing/vehicle/table_origin.h"
#include "topics.h"
#include "wing_designer.h"

namespace snapwing::nodes {

namespace {

/// Where ROS keeps what belongs to the user.
std::string defaultStore() {
  if (const char* home = std::getenv("ROS_HOME")) return std::string(home) + "/snapwing_designs";
  if (const char* home = std::getenv("HOME")) return std::string(home) + "/.ros/snapwing_designs";
  return "snapwing_designs";
}

}  // namespace

class DesignNode {
 public:
  using Result = OptimizeDesignResult;

  explicit DesignNode(Handles& handles) : DesignNode(handles, Params::fromServer(handles.own)) {}

 private:
  using Server = actionlib::SimpleActionServer<OptimizeDesignAction>;

  DesignNode(Handles& handles, Params params)
      : vehicle_(params.vehicle()),
        frame_(framePrefix(params, handles.relative.getNamespace()) + params.textOr("frame", "arm")),
        designs_(params.textOr("designs_folder", besideVehicle())),
        store_(params.textOr("store_folder", defaultStore())),
        arm_designer_(handles.relative, frame_),
        wing_designer_(handles.relative, vehicle_, frame_),
        server_(
            handles.relative, topics::OPTIMIZE_DESIGN,
            [this](const OptimizeDesignGoalConstPtr& goal) { onGoal(*goal); }, false) {
    params.finish();
    publishVehicle(handles.relative);
    server_.start();
  }

  std::string besideVehicle() const {
    return (std::filesystem::path(vehicle_.file).parent_path().parent_path() / "designs").string();
  }

  void publishVehicle(ros::NodeHandle& relative) {
    const vehicle::ForceTable table = vehicle::loadForceTable(vehicle_.arm.table_file);
    geometry_ = relative.advertise<ArmGeometry>(topics::ARM_GEOMETRY, 1, true);
    curve_ = relative.advertise<ForceDisplacementCurve>(topics::FORCE_CURVE, 1, true);
    ArmGeometry geometry = geometryMessage(vehicle_, table);
    ForceDisplacementCurve curve = curveMessage(table);
    geometry.header.frame_id = curve.header.frame_id = frame_;
    geometry.header.stamp = curve.header.stamp = ros::Time::now();
    try {  // a design changes the density first: its node shows what is there
      vehicle::requireOrigin(table, vehicle_, vehicle_.arm.table_file);
    } catch (const common::Error& error) {
      ROS_WARN_STREAM("stale table: " << error.what());
    }
    geometry_.publish(geometry);
    curve_.publish(curve);
    if (!curve.bistable) ROS_WARN("the arm's force curve is not bistable: no switch can be planned");
  }

  DesignJob jobFor(const OptimizeDesignGoal& goal, const ros::Time& begin) {
    DesignJob job;
    job.goal = goal;
    const std::filesystem::path file(goal.settings_file);
    job.settings_file = file.is_absolute() ? file.string() : (std::filesystem::path(designs_) / file).string();
    job.store_folder = store_;
    job.feedback = [this, begin](OptimizeDesignFeedback feedback) {
      feedback.seconds = (ros::Time::now() - begin).toSec();
      server_.publishFeedback(feedback);
    };
    job.preempted = [this] { return server_.isPreemptRequested() || !ros::ok(); };
    return job;
  }

  Result execute(const DesignJob& job) {
    switch (job.goal.kind) {
      case OptimizeDesignGoal::ARM:
        return arm_designer_.run(job);
      case OptimizeDesignGoal::WING:
        return wing_designer_.run(job);
      default:
        throw common::Error("kind is " + std::to_string(job.goal.kind) + "; allowed: 1 (arm), 2 (wing)");
    }
  }

  /// Runs in the action server's thread.
  void onGoal(const OptimizeDesignGoal& goal) {
    const ros::Time begin = ros::Time::now();
    Result result;
    try {
      result = execute(jobFor(goal, begin));
    } catch (const common::Error& error) {
      result.code = Result::BAD_INPUT;
      result.message = error.what();
    } catch (const std::exception& error) {
      result.code = Result::FAILED;
      result.message = error.what();
    }
    if (result.code == Result::BAD_INPUT || result.code == Result::FAILED) {
      result.objective = result.violation = std::numeric_limits<double>::quiet_NaN();
    }
    result.seconds = (ros::Time::now() - begin).toSec();
    if (result.code == Result::SUCCEEDED) {
      server_.setSucceeded(result, result.message);
    } else if (result.code == Result::PREEMPTED) {
      server_.setPreempted(result, result.message);
    } else {
      ROS_WARN_STREAM("optimize_design: " << result.message);
      server_.setAborted(result, result.message);
    }
  }

  vehicle::Vehicle vehicle_;
  std::string frame_, designs_, store_;
  ros::Publisher geometry_;
  ros::Publisher curve_;
  ArmDesigner arm_designer_;
  WingDesigner wing_designer_;
  Server server_;  ///< last: its thread uses all of the above
};

}  // namespace snapwing::nodes

int main(int argc, char** argv) {
  return snapwing::nodes::runNode<snapwing::nodes::DesignNode>(argc, argv, "design_node");
}
