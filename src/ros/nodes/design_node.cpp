/// design_node: publishes, once and latched, the arm's geometry and the force-displacement curve that was computed for
/// it; warns if the curve was computed from other inputs than those now on disk.

#include <ros/console.h>
#include <ros/publisher.h>

#include "snapwing/common/force_table.h"
#include "snapwing/ros/conversions.h"
#include "snapwing/ros/node_main.h"
#include "snapwing/ros/params.h"
#include "snapwing/ros/topics.h"

namespace snapwing::nodes {

class DesignNode {
 public:
  explicit DesignNode(Handles& handles) {
    Params params = Params::fromServer(handles.own);
    const common::Vehicle vehicle = params.vehicle();
    const std::string frame = params.textOr("frame", "arm");
    params.finish();
    const common::ForceTable table = common::loadForceTable(vehicle.arm.table_file);

    geometry_ = handles.relative.advertise<ArmGeometry>(topics::ARM_GEOMETRY, 1, true);
    curve_ = handles.relative.advertise<ForceDisplacementCurve>(topics::FORCE_CURVE, 1, true);
    ArmGeometry geometry = geometryMessage(vehicle, table);
    ForceDisplacementCurve curve = curveMessage(table);
    geometry.header.frame_id = curve.header.frame_id = frame;
    geometry.header.stamp = curve.header.stamp = ros::Time::now();
    const auto computed_for = table.provenance.find("density_sha256");
    if (computed_for == table.provenance.end() || computed_for->second != geometry.density_sha256) {
      ROS_WARN_STREAM("stale table: " << vehicle.arm.table_file << " was not computed from the density now in "
                                      << vehicle.arm.density_file);
    }
    geometry_.publish(geometry);
    curve_.publish(curve);
    if (!curve.bistable) ROS_WARN("the arm's force curve is not bistable: no switch can be planned");
  }

 private:
  ros::Publisher geometry_;
  ros::Publisher curve_;
};

}  // namespace snapwing::nodes

int main(int argc, char** argv) {
  return snapwing::nodes::runNode<snapwing::nodes::DesignNode>(argc, argv, "design_node");
}
