/// flight_link_node: pulse commands, arming and aborts from ROS to the radio bridge (LCM), its status and diagnostics
/// back. The node is the operator's heartbeat: when it dies, hangs or is stopped, the bridge disarms by itself.

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/console.h>
#include <ros/wall_timer.h>
#include <snapwing/LinkStatus.h>
#include <snapwing/PulseCommand.h>
#include <std_msgs/Bool.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>

#include <atomic>
#include <cmath>
#include <deque>
#include <functional>
#include <limits>
#include <mutex>
#include <thread>

#include "snapwing/link/clock.h"
#include "snapwing/link/operator_link.h"
#include "snapwing/link/realtime.h"
#include "snapwing/ros/node_main.h"
#include "snapwing/ros/params.h"
#include "snapwing/ros/topics.h"
#include "snapwing_lcm/abort_t.hpp"

namespace snapwing::nodes {
namespace {

constexpr char ABORT[] = "abort";                      ///< service std_srvs/Trigger
constexpr char COMMAND_DEADMAN[] = "command/deadman";  ///< std_msgs/Bool
constexpr double CYCLE_TIME = 0.06;                    ///< [s] switch shown off before it is shown on
constexpr double REFUSAL_WAIT = 0.3;                   ///< [s]

static_assert(LinkStatus::BRIDGE_IDLE == static_cast<int>(link::BridgeState::IDLE));
static_assert(LinkStatus::BRIDGE_ARMED == static_cast<int>(link::BridgeState::ARMED));
static_assert(LinkStatus::BRIDGE_PULSE == static_cast<int>(link::BridgeState::PULSE));
static_assert(LinkStatus::BRIDGE_FAULT == static_cast<int>(link::BridgeState::FAULT));

struct Settings {
  std::string lcm_url, key_file, vehicle_id, deadman;
  common::ThrottleScale throttle;  ///< with which commands are reckoned
  double heartbeat_period, command_age, spin_timeout, deadman_timeout, arm_timeout, diagnostic_interval;

  explicit Settings(Params params) {
    lcm_url = params.text("lcm_url");
    key_file = params.text("key_file");
    vehicle_id = params.textOr("vehicle_id", link::DEFAULT_VEHICLE_ID);
    const std::string vehicle_file = params.textOr("vehicle_file", "");
    if (!vehicle_file.empty()) throttle = common::throttleScaleOf(vehicle_file);
    heartbeat_period = params.number("heartbeat_period", {0.01, 0.05}, "s");
    command_age = params.number("command_age", {0.02, 0.1}, "s");
    spin_timeout = params.number("spin_timeout", {0.05, 0.2}, "s");
    deadman = params.choice("deadman", {"service", "topic"});
    deadman_timeout = params.number("deadman_timeout", {0.05, 0.2}, "s");
    arm_timeout = params.number("arm_timeout", {0.2, 5.0}, "s");
    diagnostic_interval = params.number("diagnostic_interval", {0.1, 5.0}, "s");
    params.finish();
  }
};

bool isActive(link::BridgeState state) {
  return state == link::BridgeState::ARMED || state == link::BridgeState::PULSE;
}

std::string listed(const link::Histogram& histogram) {
  std::string text;
  for (const std::int64_t count : histogram) text += (text.empty() ? "" : " ") + std::to_string(count);
  return text;
}

LinkStatus toMessage(const link::BridgeStatus& status, const link::OperatorLink& link) {
  LinkStatus message;
  message.header.stamp = ros::Time::now();
  message.session = link.session();
  message.number = status.number;
  message.vehicle_id = link.vehicleId();
  message.bridge_state = static_cast<std::uint8_t>(status.state);
  message.bridge_fault = link::describe(status.fault, status.fault_detail);
  message.pulse_id = static_cast<std::uint32_t>(status.pulse_id);
  message.frames_sent = static_cast<std::uint64_t>(status.frames_sent);
  message.channels.assign(status.channels.us.begin(), status.channels.us.begin() + status.channels.count);
  message.commanded_throttle = status.commanded_throttle;
  message.commands_accepted = static_cast<std::uint64_t>(status.commands_accepted);
  message.commands_refused = static_cast<std::uint64_t>(status.commands_refused);
  message.last_refusal = link::describe(status.last_refusal, status.last_refusal_detail);
  message.period_worst = status.period_worst;
  message.controller_connected = status.controller.connected;
  message.controller_armed = status.controller.armed;
  message.controller_failsafe = status.controller.failsafe;
  message.arming_disable_flags = status.controller.arming_flags;
  message.telemetry_age = status.telemetry_age < 0 ? std::numeric_limits<double>::quiet_NaN() : status.telemetry_age;
  if (link.telemetryKnown()) {
    const snapwing_lcm::telemetry_t& telemetry = link.telemetry();
    for (int i = 0; i < telemetry.motor_count && i < 8; ++i) {
      if (telemetry.motors[i] > 0) message.motors.push_back(static_cast<std::uint16_t>(telemetry.motors[i]));
    }
  }
  return message;
}

}  // namespace

class FlightLinkNode {
 public:
  explicit FlightLinkNode(Handles& handles)
      : settings_(Params::fromServer(handles.own)),
        publisher_(handles.relative.advertise<LinkStatus>(topics::LINK_STATUS, 10)),
        link_(settings_.lcm_url, link::Sealer(link::loadKeyFile(settings_.key_file), settings_.vehicle_id),
              [this](const link::BridgeStatus& status) { onStatus(status); }) {
    ros::NodeHandle& nh = handles.relative;
    subscriber_ =
        nh.subscribe(topics::COMMAND_PULSE, 1, &FlightLinkNode::onPulse, this, ros::TransportHints().tcpNoDelay());
    if (settings_.deadman == "topic") {
      deadman_subscriber_ = nh.subscribe(COMMAND_DEADMAN, 1, &FlightLinkNode::onDeadman, this);
    }
    services_.push_back(nh.advertiseService(topics::ARM, &FlightLinkNode::arm, this));
    services_.push_back(nh.advertiseService(topics::RESET_LINK, &FlightLinkNode::reset, this));
    services_.push_back(nh.advertiseService(ABORT, &FlightLinkNode::abort, this));
    diagnostics_.setHardwareID("flight controller");
    diagnostics_.add("link", this, &FlightLinkNode::diagnoseLink);
    diagnostics_.add("controller", this, &FlightLinkNode::diagnoseController);
    alive_timer_ = nh.createWallTimer(ros::WallDuration(0.02), [this](const ros::WallTimerEvent&) { noteAlive(); });
    diagnostic_timer_ = nh.createWallTimer(ros::WallDuration(settings_.diagnostic_interval),
                                           [this](const ros::WallTimerEvent&) { diagnostics_.update(); });
    noteAlive();
    thread_ = std::thread([this] { run(); });
  }

  ~FlightLinkNode() {
    stop_ = true;
    thread_.join();
  }

 private:
  using Task = std::function<void()>;

  // -- link's thread: the only one that touches link_

  void run() {
    link::takeRealtimePriority(link::OPERATOR_PRIORITY);
    double next_heartbeat = 0;
    bool wished = false;
    while (!stop_) {
      try {
        link_.handle(0.003);
        for (Task task; take(task);) task();
        const double now = link::monotonicSeconds();
        copyCounters();
        const bool wish = arm_wish_ && deadmanHeld(now);
        if (now < next_heartbeat && wish == wished) continue;  // a change is told at once
        wished = wish;
        next_heartbeat = now + settings_.heartbeat_period;
        link_.sendHeartbeat(arm_wish_, deadmanHeld(now), reset_wish_);
      } catch (const std::exception& error) {
        ROS_ERROR_STREAM_THROTTLE(1.0, "flight link: " << error.what());
      }
    }
  }

  void onStatus(const link::BridgeStatus& status) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      // Disarmed by itself: a switch left on must not look like a wish to arm again.
      if (isActive(status_.state) && !isActive(status.state)) arm_wish_ = false;
      status_ = status;
    }
    publisher_.publish(toMessage(status, link_));
  }

  bool take(Task& task) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (tasks_.empty()) return false;
    task = std::move(tasks_.front());
    tasks_.pop_front();
    return true;
  }

  void copyCounters() {
    const std::lock_guard<std::mutex> lock(mutex_);
    counters_ = link_.counters();
    rejected_by_bridge_ = link_.messagesRejectedByBridge();
    heard_age_ = link_.statusAge();
    if (link_.telemetryKnown()) telemetry_ = link_.telemetry();
  }

  bool deadmanHeld(double now) const {
    if (now - alive_ > settings_.spin_timeout) return false;
    return settings_.deadman == "service" || now - deadman_time_ <= settings_.deadman_timeout;
  }

  // -- callbacks

  void noteAlive() { alive_ = link::monotonicSeconds(); }
  void onDeadman(const std_msgs::Bool& message) { deadman_time_ = message.data ? link::monotonicSeconds() : -1e9; }

  void post(Task task) {
    const std::lock_guard<std::mutex> lock(mutex_);
    tasks_.push_back(std::move(task));
  }

  void onPulse(const PulseCommand& command) {
    const double age = (ros::Time::now() - command.header.stamp).toSec();
    const bool sound =
        std::isfinite(command.pulse.throttle) && std::isfinite(command.pulse.duration) && std::isfinite(command.pitch);
    if (!(std::abs(age) <= settings_.command_age) || !sound) {
      ++dropped_;
      ROS_WARN_STREAM("pulse " << command.id << " dropped: " << (sound ? "age " : "not finite, age ") << age << " s");
      return;
    }
    const std::string mismatch = link::scaleMismatch(status().throttle, settings_.throttle);
    if (!mismatch.empty()) {
      ++dropped_;
      ROS_WARN_STREAM("pulse " << command.id << " dropped: throttle is scaled in two ways: " << mismatch);
      return;
    }
    post([this, command] {
      if (!link_.sendPulse(command.id, command.pulse.throttle, command.pulse.duration, command.pitch, command.mixed)) {
        ++dropped_;
        ROS_WARN_STREAM("pulse " << command.id << " dropped: no radio bridge heard");
      }
    });
  }

  link::BridgeStatus status() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return status_;
  }

  bool bridgeAlive() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return heard_age_ < link::OperatorLink::BRIDGE_TIMEOUT;
  }

  /// Waits, while the link's thread goes on, until `done` or the time is over.
  bool wait(double seconds, const std::function<bool()>& done) {
    const double end = link::monotonicSeconds() + seconds;
    while (!done()) {
      if (link::monotonicSeconds() > end || !ros::ok()) return false;
      noteAlive();
      ros::WallDuration(0.005).sleep();
    }
    return true;
  }

  bool arm(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response) {
    response.message = request.data ? tryToArm() : disarm();
    response.success = response.message.empty();
    if (response.success) response.message = request.data ? "armed" : "disarmed";
    ROS_INFO_STREAM("arm " << (request.data ? "true: " : "false: ") << response.message);
    return true;
  }

  /// @return why not, or empty
  std::string tryToArm() {
    if (!bridgeAlive()) return "no radio bridge heard";
    const std::string mismatch = link::scaleMismatch(status().throttle, settings_.throttle);
    if (!mismatch.empty()) return "throttle is scaled in two ways: " + mismatch;
    if (isActive(status().state) && status().controller.armed) return "";
    arm_wish_ = false;
    wait(CYCLE_TIME, [] { return false; });
    const link::BridgeStatus before = status();
    arm_wish_ = true;
    wait(REFUSAL_WAIT, [&] { return isActive(status().state) || status().commands_refused > before.commands_refused; });
    if (!isActive(status().state)) {
      arm_wish_ = false;
      const link::BridgeStatus now = status();
      const bool refused = now.commands_refused > before.commands_refused;
      return refused ? describe(now.last_refusal, now.last_refusal_detail) : "the radio bridge does not answer";
    }
    wait(settings_.arm_timeout, [&] { return status().controller.armed || !isActive(status().state); });
    if (isActive(status().state) && status().controller.armed) return "";
    arm_wish_ = false;
    const link::BridgeStatus now = status();
    return now.fault == link::Fault::NONE ? "the flight controller does not report armed"
                                          : describe(now.fault, now.fault_detail);
  }

  std::string disarm() {
    arm_wish_ = false;
    const bool done = wait(REFUSAL_WAIT, [&] { return bridgeAlive() && !isActive(status().state); });
    return done ? "" : "the radio bridge does not confirm; without heartbeat it disarms by itself";
  }

  bool reset(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
    arm_wish_ = false;
    wait(CYCLE_TIME, [] { return false; });
    reset_wish_ = true;
    response.success = wait(REFUSAL_WAIT, [&] { return bridgeAlive() && status().state != link::BridgeState::FAULT; });
    reset_wish_ = false;
    const link::BridgeStatus now = status();
    response.message = response.success ? "no fault"
                       : bridgeAlive()  ? describe(now.fault, now.fault_detail)
                                        : "no radio bridge heard";
    return true;
  }

  bool abort(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
    arm_wish_ = false;
    post([this] { link_.abort(snapwing_lcm::abort_t::OPERATOR); });
    response.success = wait(REFUSAL_WAIT, [&] { return bridgeAlive() && status().state == link::BridgeState::FAULT; });
    response.message = response.success ? "aborted; reset_link clears the fault" : "the radio bridge does not confirm";
    return true;
  }

  // -- diagnostics

  void diagnoseLink(diagnostic_updater::DiagnosticStatusWrapper& out) {
    using Level = diagnostic_msgs::DiagnosticStatus;
    const std::lock_guard<std::mutex> lock(mutex_);
    const double rate = static_cast<double>(counters_.statuses - last_statuses_) / settings_.diagnostic_interval;
    const bool losing = counters_.missed > last_missed_ || counters_.rejected > last_rejected_;
    last_statuses_ = counters_.statuses;
    last_missed_ = counters_.missed;
    last_rejected_ = counters_.rejected;
    if (!(heard_age_ < link::OperatorLink::BRIDGE_TIMEOUT)) {
      out.summary(Level::ERROR, "no radio bridge heard");
    } else if (status_.state == link::BridgeState::FAULT) {
      out.summary(Level::ERROR, "fault: " + link::describe(status_.fault, status_.fault_detail));
    } else if (losing) {
      out.summary(Level::WARN, "messages lost or rejected");
    } else {
      out.summary(Level::OK, link::stateName(status_.state));
    }
    out.addf("status age [s]", "%.3f", heard_age_);
    out.addf("status rate [Hz]", "%.1f", rate);
    out.add("statuses received", counters_.statuses);
    out.add("statuses missed", counters_.missed);
    out.add("messages rejected here", counters_.rejected);
    out.add("messages rejected by the bridge", rejected_by_bridge_);
    out.add("commands accepted", status_.commands_accepted);
    out.add("commands refused", status_.commands_refused);
    out.add("commands dropped here", dropped_.load());
    out.add("frames sent", status_.frames_sent);
    out.add("frames dropped", status_.frames_dropped);
    out.addf("worst frame period [s]", "%.4f", status_.period_worst);
    out.addf("worst command latency [s]", "%.4f", status_.latency_worst);
    out.add("frames late by < .1 .2 .5 1 2 5 10 20 50 ms, more", listed(status_.period_histogram));
    out.add("commands to frame < .1 .2 .5 1 2 5 10 20 50 ms, more", listed(status_.latency_histogram));
    out.add("real-time priority", status_.realtime);
    out.add("memory locked", status_.memory_locked);
  }

  void diagnoseController(diagnostic_updater::DiagnosticStatusWrapper& out) {
    using Level = diagnostic_msgs::DiagnosticStatus;
    const std::lock_guard<std::mutex> lock(mutex_);
    const link::ControllerState& controller = status_.controller;
    if (!controller.connected) {
      out.summary(Level::ERROR, "not connected");
    } else if (controller.failsafe) {
      out.summary(Level::ERROR, "failsafe");
    } else if (!controller.known) {
      out.summary(Level::WARN, "identity or settings not read, or unsafe");
    } else {
      out.summary(Level::OK, controller.armed ? "armed" : "disarmed");
    }
    out.add("arming-disable flags", link::describeArmingFlags(controller.arming_flags));
    out.addf("telemetry age [s]", "%.3f", status_.telemetry_age);
    out.add("pilot's override switch held", controller.override_active);
    out.addf("interface version", "%d.%d", telemetry_.api_major, telemetry_.api_minor);
    out.add("variant", std::string(reinterpret_cast<const char*>(telemetry_.variant), 4).c_str());
    out.addf("failsafe delay [s]", "%.1f", telemetry_.failsafe_delay);
    out.add("failsafe procedure", telemetry_.failsafe_procedure);
    out.add("answers", telemetry_.replies);
    out.add("bad answers", telemetry_.reply_errors);
  }

  Settings settings_;
  ros::Publisher publisher_;
  std::mutex mutex_;  ///< guards what follows up to the atomics
  link::BridgeStatus status_;
  link::LinkCounters counters_;
  std::int64_t rejected_by_bridge_ = 0;
  double heard_age_ = std::numeric_limits<double>::infinity();
  snapwing_lcm::telemetry_t telemetry_{};
  std::deque<Task> tasks_;
  std::atomic<bool> stop_{false}, arm_wish_{false}, reset_wish_{false};
  std::atomic<double> alive_{0}, deadman_time_{-1e9};
  std::atomic<long> dropped_{0};
  std::int64_t last_statuses_ = 0, last_missed_ = 0, last_rejected_ = 0;  ///< callbacks' thread only
  link::OperatorLink link_;
  ros::Subscriber subscriber_, deadman_subscriber_;
  std::vector<ros::ServiceServer> services_;
  diagnostic_updater::Updater diagnostics_;
  ros::WallTimer alive_timer_, diagnostic_timer_;
  std::thread thread_;
};

}  // namespace snapwing::nodes

int main(int argc, char** argv) {
  return snapwing::nodes::runNode<snapwing::nodes::FlightLinkNode>(argc, argv, "flight_link_node");
}
