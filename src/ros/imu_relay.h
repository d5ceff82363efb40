#pragma once
/// The flight controller's accelerometer as the topic `imu`, for vehicles on which nothing else measures.

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>
#include <sensor_msgs/Imu.h>

#include <atomic>
#include <string>

#include "snapwing_lcm/telemetry_t.hpp"

namespace snapwing::nodes {

/// The reading as a message. @param now  [s] ROS time at which the telemetry came
sensor_msgs::Imu toImu(const snapwing_lcm::telemetry_t& telemetry, double now, const std::string& frame);

class ImuRelay {
 public:
  enum class Use { AUTO, ON, OFF };

  /// @param use  AUTO: only while no other publisher of the topic is heard
  ImuRelay(ros::NodeHandle& nh, Use use, const std::string& frame);

  /// Publishes the reading, or not. From any thread.
  void pass(const snapwing_lcm::telemetry_t& telemetry);

 private:
  void onImu(const ros::MessageEvent<sensor_msgs::Imu const>& event);

  Use use_;
  std::string frame_;
  std::atomic<double> other_heard_;  ///< [s] steady clock
  ros::Publisher publisher_;
  ros::Subscriber others_;
};

}  // namespace snapwing::nodes
