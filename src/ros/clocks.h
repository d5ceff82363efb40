#pragma once
/// The two clocks for common/time_watch.h, read at the same moment.

#include <ros/time.h>

#include <chrono>

namespace snapwing::nodes {

struct Clocks {
  double now = 0;     ///< [s] ROS time, by which messages are stamped; 0 = there is none yet
  double steady = 0;  ///< [s] monotonic, independent of ROS time

  static Clocks read() {
    const std::chrono::duration<double> steady = std::chrono::steady_clock::now().time_since_epoch();
    return {ros::Time::now().toSec(), steady.count()};
  }
};

}  // namespace snapwing::nodes
