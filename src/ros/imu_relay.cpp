#include "imu_relay.h"

#include <ros/this_node.h>

#include <algorithm>

#include "clocks.h"
#include "topics.h"

namespace snapwing::nodes {
namespace {

constexpr double PATIENCE = 2.0;  ///< [s] without another publisher, then this one speaks

}  // namespace

sensor_msgs::Imu toImu(const snapwing_lcm::telemetry_t& telemetry, double now, const std::string& frame) {
  sensor_msgs::Imu message;
  message.header.stamp = ros::Time(std::max(0.0, now - std::max(0.0, telemetry.imu_age)));
  message.header.frame_id = frame;
  message.orientation_covariance[0] = -1;  // not measured
  message.angular_velocity_covariance[0] = -1;
  message.linear_acceleration.x = telemetry.imu_acceleration[0];
  message.linear_acceleration.y = telemetry.imu_acceleration[1];
  message.linear_acceleration.z = telemetry.imu_acceleration[2];
  return message;
}

ImuRelay::ImuRelay(ros::NodeHandle& nh, Use use, const std::string& frame)
    : use_(use), frame_(frame), other_heard_(Clocks::read().steady) {
  if (use_ != Use::OFF) publisher_ = nh.advertise<sensor_msgs::Imu>(topics::IMU, 20);
  if (use_ == Use::AUTO) others_ = nh.subscribe(topics::IMU, 1, &ImuRelay::onImu, this);
}

void ImuRelay::onImu(const ros::MessageEvent<sensor_msgs::Imu const>& event) {
  if (event.getPublisherName() != ros::this_node::getName()) other_heard_ = Clocks::read().steady;
}

void ImuRelay::pass(const snapwing_lcm::telemetry_t& telemetry) {
  const Clocks clocks = Clocks::read();
  if (use_ == Use::OFF || clocks.now <= 0) return;
  if (use_ == Use::AUTO && clocks.steady - other_heard_ < PATIENCE) return;
  publisher_.publish(toImu(telemetry, clocks.now, frame_));
}

}  // namespace snapwing::nodes
