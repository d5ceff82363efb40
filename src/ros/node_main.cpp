#include "node_main.h"

#include <ros/callback_queue.h>
#include <ros/console.h>
#include <ros/init.h>

#include <exception>

namespace snapwing::nodes {

namespace {

/// As ros::spin(), but asleep while ROS shuts down. Its queue is disabled then and returns at once: a loop over it
/// would turn without a pause, and at a real-time priority keep those from the processor who have to end the shutdown.
void spin() {
  while (ros::ok() && !ros::isShuttingDown()) ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.1));
  while (ros::ok()) ros::WallDuration(0.005).sleep();
}

}  // namespace

int runNode(int argc, char** argv, const std::string& name,
            const std::function<std::shared_ptr<void>(Handles&)>& make) {
  ros::init(argc, argv, name);
  Handles handles;  // outlives the catch below: with the last handle the console goes, and the message with it
  try {
    const std::shared_ptr<void> node = make(handles);
    spin();
    return 0;
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM(name << ": " << error.what());
    return 2;
  }
}

}  // namespace snapwing::nodes
