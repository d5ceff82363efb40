#include "snapwing/ros/node_main.h"

#include <ros/console.h>
#include <ros/init.h>

#include <exception>

namespace snapwing::nodes {

int runNode(int argc, char** argv, const std::string& name,
            const std::function<std::shared_ptr<void>(Handles&)>& make) {
  ros::init(argc, argv, name);
  Handles handles;  // outlives the catch below: with the last handle the console goes, and the message with it
  try {
    const std::shared_ptr<void> node = make(handles);
    ros::spin();
    return 0;
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM(name << ": " << error.what());
    return 2;
  }
}

}  // namespace snapwing::nodes
