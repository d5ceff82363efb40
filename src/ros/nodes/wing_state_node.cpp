/// wing_state_node: estimates travel and mode from the frames sent to the flight controller and the centre's IMU, and
/// publishes the estimate (mode_state), frames (tf2) and markers. It knows nothing of the simulation's truth.

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/console.h>
#include <ros/publisher.h>
#include <ros/service_server.h>
#include <ros/subscriber.h>
#include <ros/timer.h>
#include <sensor_msgs/Imu.h>
#include <snapwing/LinkStatus.h>
#include <snapwing/ModeState.h>
#include <std_srvs/SetBool.h>
#include <tf2_ros/transform_broadcaster.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "snapwing/common/error.h"
#include "snapwing/common/table_origin.h"
#include "snapwing/common/wing_table.h"
#include "snapwing/planning/mode_estimator.h"
#include "snapwing/ros/conversions.h"
#include "snapwing/ros/node_main.h"
#include "snapwing/ros/params.h"
#include "snapwing/ros/topics.h"
#include "snapwing/ros/vehicle_picture.h"

namespace snapwing::nodes {

namespace {

struct WingStateSettings {
  planning::EstimatorSettings estimator;
  common::Mode initial_mode = common::Mode::UNKNOWN;
  bool read_back = false;     ///< motor outputs as read back; else computed from the frames sent
  double input_delay = 0;     ///< [s] inputs are put in order of their stamps within this time
  double link_timeout = 0;    ///< [s] without link status the motors count as stopped
  double state_rate = 0;      ///< [Hz]
  double marker_rate = 0;     ///< [Hz]
  double display_height = 0;  ///< [m] of base_link over map
  std::string map_frame;
  PictureSettings picture;
};

WingStateSettings readSettings(Params& params, const common::Vehicle& vehicle) {
  WingStateSettings s;
  s.estimator.particles = params.integer("particles", 10, 20000);
  s.estimator.seed = static_cast<std::uint64_t>(params.integer("seed", 0, 1000000));
  s.estimator.accelerometer_noise = params.number("accelerometer_noise", {1e-3, 20.0}, "m/s2");
  s.estimator.accelerometer_bias = params.number("accelerometer_bias", {0.0, 5.0}, "m/s2");
  s.estimator.outlier_share = params.number("outlier_share", {0.0, 0.5}, "1");
  s.estimator.outside_force = params.number("outside_force", {0.0, 1000.0}, "N");
  s.estimator.outside_rate = params.number("outside_rate", {0.0, 100.0}, "1/s");
  s.estimator.outside_time = params.number("outside_time", {0.01, 100.0}, "s");
  s.estimator.model_error = params.number("model_error", {0.0, 0.5}, "1");
  s.estimator.travel_error = params.number("travel_error", {0.0, 0.01}, "m");
  s.estimator.step = params.number("step", {1e-4, 0.01}, "s");
  s.estimator.sure = params.number("sure", {0.5, 0.9999}, "1");
  s.estimator.mount = rom::mountFor(vehicle, params.choice("mount", {"auto", "free", "boom", "held"}), "mount");
  s.estimator.wings = rom::wingsFromName(params.choice("wings", {"auto", "on", "off"}));
  s.estimator.gravity = params.number("gravity", {-9.83, 9.83}, "m/s2");
  const std::string initial = params.choice("initial_mode", {"F", "Q", "unknown"});
  s.initial_mode = initial == "unknown" ? common::Mode::UNKNOWN : common::modeFromName(initial);
  s.read_back = params.choice("motor_source", {"frames", "read_back"}) == "read_back";
  s.input_delay = params.number("input_delay", {0.0, 0.5}, "s");
  s.link_timeout = params.number("link_timeout", {0.1, 5.0}, "s");
  s.state_rate = params.number("state_rate", {1.0, 200.0}, "Hz");
  s.marker_rate = params.number("marker_rate", {1.0, 60.0}, "Hz");
  s.display_height = params.number("display_height", {-100.0, 100.0}, "m");
  s.map_frame = params.text("map_frame");
  s.picture.ring_frame = params.text("ring_frame");
  s.picture.housing_frame = params.text("housing_frame");
  return s;
}

/// One reading for the estimator.
struct Input {
  bool motors;   ///< else accelerometer
  double value;  ///< [1] mean motor output, or [m/s2]
};

}  // namespace

class WingStateNode {
 public:
  explicit WingStateNode(Handles& handles) : WingStateNode(handles, Params::fromServer(handles.own)) {}

 private:
  WingStateNode(Handles& handles, Params params)
      : vehicle_(params.vehicle()),
        settings_(readSettings(params, vehicle_)),
        table_(common::armTableOf(vehicle_)),
        wing_(common::wingTableOf(vehicle_, table_)),
        estimator_(vehicle_, table_, settings_.estimator, wing_),
        picture_(vehicle_, table_, settings_.picture) {
    params.finish();
    useWing();
    ros::NodeHandle& nh = handles.relative;
    state_publisher_ = nh.advertise<ModeState>(topics::MODE_STATE, 50);
    marker_publisher_ = nh.advertise<visualization_msgs::MarkerArray>(topics::MARKERS, 5);
    imu_ = nh.subscribe(topics::IMU, 200, &WingStateNode::onImu, this);
    link_ = nh.subscribe(topics::LINK_STATUS, 50, &WingStateNode::onLink, this);
    ring_held_ = nh.advertiseService(topics::RING_HELD, &WingStateNode::onRingHeld, this);
    start_ = ros::Time::now();
    estimator_.reset(0, settings_.initial_mode);
    state_timer_ = nh.createTimer(ros::Duration(1 / settings_.state_rate), &WingStateNode::publishState, this);
    marker_timer_ = nh.createTimer(ros::Duration(1 / settings_.marker_rate), &WingStateNode::publishMarkers, this);
    diagnostics_.setHardwareID(vehicle_.name);
    diagnostics_.add("mode estimate", this, &WingStateNode::diagnose);
    diagnostic_timer_ = nh.createTimer(ros::Duration(0.5), [this](const ros::TimerEvent&) { diagnostics_.update(); });
  }

  double seconds(const ros::Time& stamp) const { return (stamp - start_).toSec(); }

  void onImu(const sensor_msgs::Imu& message) {
    last_imu_ = ros::Time::now();
    inputs_.emplace(seconds(message.header.stamp), Input{false, message.linear_acceleration.z});
  }

  void onLink(const LinkStatus& message) {
    link_status_ = message;
    last_link_ = ros::Time::now();
    const double delay = settings_.read_back ? 0 : vehicle_.radio.latency.value;
    inputs_.emplace(seconds(message.header.stamp) + delay, Input{true, motorOutput(message)});
  }

  /// Mean motor output. A flight controller that is not armed, or in failsafe, turns nothing.
  double motorOutput(const LinkStatus& link) const {
    if (!link.controller_armed || link.controller_failsafe) return 0;
    const common::Radio& radio = vehicle_.radio;
    if (settings_.read_back) {
      double sum = 0;
      const std::size_t count =
          std::min<std::size_t>(link.motors.size(), static_cast<std::size_t>(vehicle_.rotors.count));
      for (std::size_t i = 0; i < count; ++i) sum += common::motorOutputFromMicroseconds(radio, link.motors[i]);
      return count > 0 ? sum / static_cast<double>(count) : 0;
    }
    if (link.channels.size() < 3) return 0;
    return common::motorOutput(radio, common::throttleFromMicroseconds(common::throttleScale(radio), link.channels[2]));
  }

  /// The operator tells that the ring is held and stands still, or is let go: until then the estimate's speed is 0.
  bool onRingHeld(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response) {
    held_ = request.data;
    response.success = true;
    return true;
  }

  /// Gives the estimator everything stamped before `time`, in order.
  void feed(double time) {
    while (!inputs_.empty() && inputs_.begin()->first <= time) {
      const auto [when, input] = *inputs_.begin();
      inputs_.erase(inputs_.begin());
      input.motors ? estimator_.motorOutput(when, input.value) : estimator_.accelerometer(when, input.value);
    }
  }

  void publishState(const ros::TimerEvent&) {
    const ros::Time stamp = ros::Time::now() - ros::Duration(settings_.input_delay);
    // A flight controller that hears nothing stops the motors: its failsafe.
    if (!last_link_.isZero() && stamp - last_link_ > ros::Duration(settings_.link_timeout)) {
      inputs_.emplace(seconds(stamp), Input{true, 0.0});
    }
    feed(seconds(stamp));
    estimator_.predictTo(seconds(stamp));
    if (held_) estimator_.atRest(seconds(stamp));
    estimate_ = estimator_.estimate();
    ModeState message;
    message.header.stamp = stamp;
    message.header.frame_id = settings_.picture.ring_frame;
    message.mode = toMessage(estimate_.mode);
    message.probability_fixed_wing = estimate_.probability_fixed_wing;
    message.probability_quadrotor = estimate_.probability_quadrotor;
    message.travel = estimate_.travel;
    message.travel_deviation = estimate_.travel_deviation;
    message.wing_angle = wingAngle();
    state_publisher_.publish(message);
    publishFrames(stamp);
  }

  void useWing() {
    if (!wing_) return;
    if (!wing_->hasBlade()) throw common::FileError(vehicle_.wing.table_file, "has no blade: made by an older version");
    picture_.useWing(*wing_);
  }

  /// [rad] 0 = unfolded, positive as the wing folds: by the wing's table at the estimated travel. NaN without wings.
  double wingAngle() const {
    if (!wing_) return std::numeric_limits<double>::quiet_NaN();
    return std::copysign(1.0, wing_->wing_angle.back()) * wing_->at(wing_->wing_angle, estimate_.travel);
  }

  void publishFrames(const ros::Time& stamp) {
    geometry_msgs::TransformStamped ring, housing;
    ring.header.stamp = housing.header.stamp = stamp;
    ring.header.frame_id = settings_.map_frame;
    ring.child_frame_id = housing.header.frame_id = settings_.picture.ring_frame;
    housing.child_frame_id = settings_.picture.housing_frame;
    ring.transform.rotation.w = housing.transform.rotation.w = 1;
    ring.transform.translation.z = settings_.display_height;
    housing.transform.translation.z = picture_.housingHeight(estimate_.travel);
    frames_.sendTransform({ring, housing});
  }

  void publishMarkers(const ros::TimerEvent&) {
    PictureState state;
    state.travel = estimate_.travel;
    state.mode = estimate_.mode;
    state.stamp = ros::Time::now() - ros::Duration(settings_.input_delay);
    state.label = label();
    const bool fresh = !last_link_.isZero() && ros::Time::now() - last_link_ < ros::Duration(0.5);
    const double thrust =
        fresh ? common::thrustFraction(vehicle_.rotors.quadratic_share.value, motorOutput(link_status_)) : 0;
    state.thrust.assign(static_cast<std::size_t>(vehicle_.rotors.count), thrust);
    marker_publisher_.publish(picture_.draw(state));
  }

  std::string label() const {
    const double best = std::max(estimate_.probability_fixed_wing, estimate_.probability_quadrotor);
    std::string text = estimate_.mode == common::Mode::FIXED_WING  ? "FIXED WING"
                       : estimate_.mode == common::Mode::QUADROTOR ? "QUADROTOR"
                                                                   : "mode not known";
    char numbers[64];
    std::snprintf(numbers, sizeof numbers, "  %.0f %%   u = %.0f mm", 100 * best, 1000 * estimate_.travel);
    text += numbers;
    if (link_status_.controller_failsafe)
      text += "\nFAILSAFE";
    else if (!link_status_.bridge_fault.empty())
      text += "\nlink: " + link_status_.bridge_fault;
    return text;
  }

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
    using diagnostic_msgs::DiagnosticStatus;
    const ros::Time now = ros::Time::now();
    if (last_imu_.isZero() || now - last_imu_ > ros::Duration(0.5)) {
      status.summary(DiagnosticStatus::ERROR, "no IMU");
    } else if (last_link_.isZero() || now - last_link_ > ros::Duration(0.5)) {
      status.summary(DiagnosticStatus::WARN, "no link status: motor outputs are not known");
    } else if (estimate_.mode == common::Mode::UNKNOWN) {
      status.summary(DiagnosticStatus::WARN, "mode not known");
    } else {
      status.summary(DiagnosticStatus::OK, "mode " + common::modeName(estimate_.mode));
    }
    status.add("probability F", estimate_.probability_fixed_wing);
    status.add("probability Q", estimate_.probability_quadrotor);
    status.add("travel [m]", estimate_.travel);
    status.add("travel deviation [m]", estimate_.travel_deviation);
    status.add("effective particles", estimate_.effective_particles);
    status.add("inputs waiting", inputs_.size());
  }

  common::Vehicle vehicle_;
  WingStateSettings settings_;
  common::ForceTable table_;
  std::optional<common::WingTable> wing_;
  planning::ModeEstimator estimator_;
  VehiclePicture picture_;
  planning::ModeEstimate estimate_;
  std::multimap<double, Input> inputs_;
  LinkStatus link_status_;
  ros::Time start_, last_imu_, last_link_;
  ros::Publisher state_publisher_, marker_publisher_;
  ros::Subscriber imu_, link_;
  ros::ServiceServer ring_held_;
  bool held_ = false;
  tf2_ros::TransformBroadcaster frames_;
  diagnostic_updater::Updater diagnostics_;
  ros::Timer state_timer_, marker_timer_, diagnostic_timer_;
};

}  // namespace snapwing::nodes

int main(int argc, char** argv) {
  return snapwing::nodes::runNode<snapwing::nodes::WingStateNode>(argc, argv, "wing_state_node");
}
