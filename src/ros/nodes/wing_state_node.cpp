/// wing_state_node: estimates travel and mode from the frames sent to the flight controller and the centre's IMU, and
/// publishes the estimate (mode_state), frames (tf2) and markers. It knows nothing of the simulation's truth.

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/console.h>
#include <ros/publisher.h>
#include <ros/service_server.h>
#include <ros/subscriber.h>
#include <ros/wall_timer.h>
#include <sensor_msgs/Imu.h>
#include <snapwing/LinkStatus.h>
#include <snapwing/ModeState.h>
#include <snapwing/StateMode.h>
#include <std_srvs/SetBool.h>
#include <sys/resource.h>
#include <tf2_ros/transform_broadcaster.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "clocks.h"
#include "conversions.h"
#include "node_main.h"
#include "params.h"
#include "snapwing/common/error.h"
#include "snapwing/planning/mode_observer.h"
#include "snapwing/vehicle/table_origin.h"
#include "snapwing/vehicle/wing_table.h"
#include "topics.h"
#include "vehicle_picture.h"

namespace snapwing::nodes {

namespace {

// No longer than what the observer would still use at 200 Hz (most_behind): of a longer backlog the newest are kept.
constexpr std::uint32_t IMU_QUEUE = 120;

struct WingStateSettings {
  planning::EstimatorSettings estimator;
  planning::ObserverSettings observer;
  bool read_back = false;     ///< motor outputs as read back; else computed from the frames sent
  double state_rate = 0;      ///< [Hz]
  double marker_rate = 0;     ///< [Hz]
  double display_height = 0;  ///< [m] of base_link over map
  std::string map_frame;
  PictureSettings picture;
};

WingStateSettings readSettings(Params& params, const vehicle::Vehicle& vehicle, const std::string& name_space) {
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
  s.estimator.mount = vehicle::mountFor(vehicle, params.choice("mount", {"auto", "free", "boom", "held"}), "mount");
  s.estimator.wings = vehicle::wingsFromName(params.choice("wings", {"auto", "on", "off"}));
  s.estimator.gravity = params.number("gravity", {-9.83, 9.83}, "m/s2");
  s.estimator.longest_gap = params.number("longest_gap", {0.1, 10.0}, "s");
  s.estimator.validate();
  const std::string initial = params.choice("initial_mode", {"F", "Q", "unknown"});
  s.observer.stated = initial == "unknown" ? vehicle::Mode::UNKNOWN : vehicle::modeFromName(initial);
  s.observer.input_delay = params.number("input_delay", {0.0, 0.5}, "s");
  s.observer.link_timeout = params.number("link_timeout", {0.1, 5.0}, "s");
  s.observer.frame_delay = params.number("frame_delay", {0.0, 0.2}, "s");
  s.observer.silence = params.number("silence", {0.05, 1.0}, "s");
  s.observer.least_rate = params.number("least_rate", {0.0, 200.0}, "Hz");
  s.read_back = params.choice("motor_source", {"frames", "read_back"}) == "read_back";
  s.state_rate = params.number("state_rate", {1.0, 200.0}, "Hz");
  s.marker_rate = params.number("marker_rate", {1.0, 60.0}, "Hz");
  s.display_height = params.number("display_height", {-100.0, 100.0}, "m");
  s.map_frame = params.text("map_frame");
  const std::string prefix = framePrefix(params, name_space);
  s.picture.ring_frame = prefix + params.text("ring_frame");
  s.picture.housing_frame = prefix + params.text("housing_frame");
  return s;
}

}  // namespace

class WingStateNode {
 public:
  explicit WingStateNode(Handles& handles) : WingStateNode(handles, Params::fromServer(handles.own)) {}

 private:
  WingStateNode(Handles& handles, Params params)
      : vehicle_(params.vehicle()),
        settings_(readSettings(params, vehicle_, handles.relative.getNamespace())),
        table_(vehicle::armTableOf(vehicle_)),
        wing_(vehicle::wingTableOf(vehicle_, table_)),
        observer_(planning::ModeEstimator(vehicle_, table_, settings_.estimator, wing_), observerSettings()),
        picture_(vehicle_, table_, settings_.picture) {
    params.finish();
    useWing();
    ros::NodeHandle& nh = handles.relative;
    state_publisher_ = nh.advertise<ModeState>(topics::MODE_STATE, 50);
    marker_publisher_ = nh.advertise<visualization_msgs::MarkerArray>(topics::MARKERS, 5);
    imu_ = nh.subscribe(topics::IMU, IMU_QUEUE, &WingStateNode::onImu, this);
    link_ = nh.subscribe(topics::LINK_STATUS, 50, &WingStateNode::onLink, this);
    ring_held_ = nh.advertiseService(topics::RING_HELD, &WingStateNode::onRingHeld, this);
    state_mode_ = nh.advertiseService(topics::STATE_MODE, &WingStateNode::onStateMode, this);
    // Timers of the steady clock: they go on when ROS time stands, jumps or is not there yet.
    state_timer_ = nh.createWallTimer(ros::WallDuration(1 / settings_.state_rate),
                                      [this](const ros::WallTimerEvent&) { publishState(); });
    marker_timer_ = nh.createWallTimer(ros::WallDuration(1 / settings_.marker_rate),
                                       [this](const ros::WallTimerEvent&) { publishMarkers(); });
    diagnostics_.setHardwareID(vehicle_.name);
    diagnostics_.add("mode estimate", this, &WingStateNode::diagnose);
    diagnostic_timer_ =
        nh.createWallTimer(ros::WallDuration(0.5), [this](const ros::WallTimerEvent&) { diagnostics_.update(); });
  }

  planning::ObserverSettings observerSettings() const {
    planning::ObserverSettings settings = settings_.observer;
    settings.idle_output = std::min(1.0, vehicle::motorOutput(vehicle_.radio, 0.0) + 0.02);
    return settings;
  }

  void onImu(const sensor_msgs::Imu& message) {
    const Clocks clocks = Clocks::read();
    observer_.reading(message.header.stamp.toSec(), message.linear_acceleration.z, clocks.now, clocks.steady);
  }

  void onLink(const LinkStatus& message) {
    const Clocks clocks = Clocks::read();
    link_status_ = message;
    const double delay = settings_.read_back ? 0 : settings_.observer.frame_delay;
    observer_.motors(message.header.stamp.toSec(), motorOutput(message), delay, clocks.now, clocks.steady);
  }

  /// Mean motor output. A flight controller that is not armed, or in failsafe, turns nothing.
  double motorOutput(const LinkStatus& link) const {
    if (!link.controller_armed || link.controller_failsafe) return 0;
    const vehicle::Radio& radio = vehicle_.radio;
    if (settings_.read_back) {
      double sum = 0;
      const std::size_t count =
          std::min<std::size_t>(link.motors.size(), static_cast<std::size_t>(vehicle_.rotors.count));
      for (std::size_t i = 0; i < count; ++i) sum += vehicle::motorOutputFromMicroseconds(radio, link.motors[i]);
      return count > 0 ? sum / static_cast<double>(count) : 0;
    }
    if (link.channels.size() < 3) return 0;
    return vehicle::motorOutput(radio,
                                common::throttleFromMicroseconds(vehicle::throttleScale(radio), link.channels[2]));
  }

  /// The operator tells that the ring is held and stands still, or is let go: until then the estimate's speed is 0.
  bool onRingHeld(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response) {
    observer_.holdRing(request.data);
    response.success = true;
    return true;
  }

  /// The operator sees the mode: after a silence or a jump of the clock nothing else may show it.
  bool onStateMode(StateMode::Request& request, StateMode::Response& response) {
    response.success = request.mode <= StateMode::Request::QUADROTOR;
    if (response.success) {
      observer_.state(modeFromMessage(request.mode));
    } else {
      response.message = "mode is " + std::to_string(request.mode) + "; allowed: 0 (unknown), 1 (F), 2 (Q)";
    }
    return true;
  }

  void publishState() {
    const Clocks clocks = Clocks::read();
    report_ = observer_.update(clocks.now, clocks.steady);
    if (!report_.fresh) return;  // no stamp is used twice, whatever the clock's rate
    const planning::ModeEstimate& estimate = report_.estimate;
    shown_ = planning::shownMode(shown_, estimate);
    ModeState message;
    message.header.stamp = ros::Time(report_.stamp);
    message.header.frame_id = settings_.picture.ring_frame;
    message.mode = toMessage(estimate.mode);
    message.reason = estimate.reason;
    message.probability_fixed_wing = estimate.probability_fixed_wing;
    message.probability_quadrotor = estimate.probability_quadrotor;
    message.travel = estimate.travel;
    message.travel_deviation = estimate.travel_deviation;
    message.wing_angle = wingAngle(estimate.travelIn(shown_));
    message.reading_age = report_.reading_age;
    state_publisher_.publish(message);
    publishFrames(message.header.stamp);
  }

  void useWing() {
    if (!wing_) return;
    if (!wing_->hasBlade()) throw common::FileError(vehicle_.wing.table_file, "has no blade: made by an older version");
    picture_.useWing(*wing_);
  }

  /// [rad] 0 = unfolded, positive as the wing folds: by the wing's table at a travel [m]. NaN without wings.
  double wingAngle(double travel) const {
    if (!wing_) return std::numeric_limits<double>::quiet_NaN();
    return std::copysign(1.0, wing_->wing_angle.back()) * wing_->at(wing_->wing_angle, travel);
  }

  void publishFrames(const ros::Time& stamp) {
    geometry_msgs::TransformStamped ring, housing;
    ring.header.stamp = housing.header.stamp = stamp;
    ring.header.frame_id = settings_.map_frame;
    ring.child_frame_id = housing.header.frame_id = settings_.picture.ring_frame;
    housing.child_frame_id = settings_.picture.housing_frame;
    ring.transform.rotation.w = housing.transform.rotation.w = 1;
    ring.transform.translation.z = settings_.display_height;
    housing.transform.translation.z = picture_.housingHeight(report_.estimate.travelIn(shown_));
    frames_.sendTransform({ring, housing});
  }

  /// Draws the mode that is shown; while the mode is not known, faintly, and the other one beside it. A mean of two
  /// modes is the state of no vehicle and is never drawn.
  void publishMarkers() {
    if (report_.stamp <= marker_stamp_) {
      if (report_.stamp > 0 && report_.stamp > marker_stamp_ - 1.0) return;  // else the clock was set back
    }
    marker_stamp_ = report_.stamp;
    if (marker_stamp_ <= 0) return;
    const Clocks clocks = Clocks::read();
    const planning::ModeEstimate& estimate = report_.estimate;
    PictureState state;
    state.travel = estimate.travelIn(shown_);
    state.mode = estimate.mode;
    state.stamp = ros::Time(report_.stamp);
    state.label = label();
    if (estimate.mode == vehicle::Mode::UNKNOWN) {
      state.alpha = 0.5;
      state.ghost_travel = estimate.travelIn(vehicle::otherMode(shown_));
    }
    const bool fresh = observer_.links().age(clocks.now, clocks.steady) < 0.5;
    const double thrust =
        fresh ? vehicle::thrustFraction(vehicle_.rotors.quadratic_share.value, motorOutput(link_status_)) : 0;
    state.thrust.assign(static_cast<std::size_t>(vehicle_.rotors.count), thrust);
    marker_publisher_.publish(picture_.draw(state));
  }

  std::string label() const {
    const planning::ModeEstimate& estimate = report_.estimate;
    const double best = std::max(estimate.probability_fixed_wing, estimate.probability_quadrotor);
    std::string text = estimate.mode == vehicle::Mode::FIXED_WING  ? "FIXED WING"
                       : estimate.mode == vehicle::Mode::QUADROTOR ? "QUADROTOR"
                                                                   : "mode not known";
    char numbers[64];
    std::snprintf(numbers, sizeof numbers, "  %.0f %%   u = %.0f mm", 100 * best, 1000 * estimate.travelIn(shown_));
    text += estimate.mode == vehicle::Mode::UNKNOWN ? "\n" + estimate.reason : numbers;
    if (link_status_.controller_failsafe)
      text += "\nFAILSAFE";
    else if (!link_status_.bridge_fault.empty())
      text += "\nlink: " + link_status_.bridge_fault;
    return text;
  }

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
    using common::StampVerdict;
    using diagnostic_msgs::DiagnosticStatus;
    const Clocks clocks = Clocks::read();
    const planning::ModeEstimate& estimate = report_.estimate;
    const common::StampWatch &readings = observer_.readings(), &links = observer_.links();
    const std::string imu = readings.trouble(clocks.now, clocks.steady, 0.5);
    const std::string link = links.trouble(clocks.now, clocks.steady, 0.5);
    if (!imu.empty()) {
      status.summary(DiagnosticStatus::ERROR, "the IMU " + imu);
    } else if (!link.empty()) {
      status.summary(DiagnosticStatus::WARN, "the link status " + link + ": motor outputs are not known");
    } else if (estimate.mode == vehicle::Mode::UNKNOWN) {
      status.summary(DiagnosticStatus::WARN, "mode not known: " + estimate.reason);
    } else {
      status.summary(DiagnosticStatus::OK, "mode " + vehicle::modeName(estimate.mode));
    }
    status.add("probability F", estimate.probability_fixed_wing);
    status.add("probability Q", estimate.probability_quadrotor);
    status.add("probability of being lost", estimate.lost);
    status.add("travel [m]", estimate.travel);
    status.add("travel deviation [m]", estimate.travel_deviation);
    status.add("effective particles", estimate.effective_particles);
    status.add("IMU rate [Hz]", observer_.readingRate());
    status.add("inputs waiting", observer_.waiting());
    status.add("readings skipped for newer ones", observer_.skipped());
    status.add("jumps of the clock", observer_.jumps());
    status.add("readings used", readings.count(StampVerdict::GOOD));
    status.add("readings stamped ahead of the clock", readings.count(StampVerdict::FUTURE));
    status.add("readings that came too late", readings.count(StampVerdict::STALE));
    status.add("readings that repeat a stamp or go back",
               readings.count(StampVerdict::REPEATED) + readings.count(StampVerdict::OLDER));
    status.add("readings without a stamp or a number",
               readings.count(StampVerdict::UNSTAMPED) + observer_.notNumbers());
  }

  vehicle::Vehicle vehicle_;
  WingStateSettings settings_;
  vehicle::ForceTable table_;
  std::optional<vehicle::WingTable> wing_;
  planning::ModeObserver observer_;
  VehiclePicture picture_;
  planning::ModeReport report_;
  vehicle::Mode shown_ = vehicle::Mode::FIXED_WING;  ///< in pictures and frames
  double marker_stamp_ = 0;
  LinkStatus link_status_;
  ros::Publisher state_publisher_, marker_publisher_;
  ros::Subscriber imu_, link_;
  ros::ServiceServer ring_held_, state_mode_;
  tf2_ros::TransformBroadcaster frames_;
  diagnostic_updater::Updater diagnostics_;
  ros::WallTimer state_timer_, marker_timer_, diagnostic_timer_;
};

}  // namespace snapwing::nodes

int main(int argc, char** argv) {
  // Before the planner's search, where that is allowed. No real-time priority: on a slow computer it works all the
  // time.
  setpriority(PRIO_PROCESS, 0, -10);
  return snapwing::nodes::runNode<snapwing::nodes::WingStateNode>(argc, argv, "wing_state_node");
}
