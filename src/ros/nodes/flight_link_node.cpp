/// flight_link_node: pulse commands, arming and aborts from ROS to the radio bridge (LCM), its status and diagnostics
/// back. The node is the operator's heartbeat: when it dies, hangs or is stopped, the bridge disarms by itself.
///
/// Threads: LinkWorker's alone talks to the bridge. Aborts and the deadman have a callback queue and threads of their
/// own, so that they never wait behind an arm or a reset, which have another. Everything runs at OPERATOR_PRIORITY, if
/// that is granted.

#include <ros/callback_queue.h>
#include <ros/console.h>
#include <ros/publisher.h>
#include <ros/service_server.h>
#include <ros/subscriber.h>
#include <ros/wall_timer.h>
#include <snapwing/Arm.h>
#include <snapwing/PulseCommand.h>
#include <snapwing/ResetLink.h>
#include <std_msgs/Bool.h>
#include <std_srvs/Trigger.h>

#include <atomic>
#include <cmath>
#include <thread>
#include <vector>

#include "imu_relay.h"
#include "link_diagnostics.h"
#include "link_worker.h"
#include "node_main.h"
#include "params.h"
#include "seal_conversions.h"
#include "snapwing/common/error.h"
#include "snapwing/link/realtime.h"
#include "topics.h"

namespace snapwing::nodes {
namespace {

constexpr char ABORT[] = "abort";                      ///< service std_srvs/Trigger
constexpr char COMMAND_DEADMAN[] = "command/deadman";  ///< std_msgs/Bool
constexpr double SPIN_PERIOD = 0.02;                   ///< [s] longest pause between two looks into a queue
constexpr int URGENT_THREADS = 2;                      ///< an abort that waits for its answer leaves the deadman one

static_assert(LinkStatus::BRIDGE_IDLE == static_cast<int>(link::BridgeState::IDLE));
static_assert(LinkStatus::BRIDGE_ARMED == static_cast<int>(link::BridgeState::ARMED));
static_assert(LinkStatus::BRIDGE_PULSE == static_cast<int>(link::BridgeState::PULSE));
static_assert(LinkStatus::BRIDGE_FAULT == static_cast<int>(link::BridgeState::FAULT));

struct Settings {
  LinkWorkerSettings worker;
  double diagnostic_interval;
  ImuRelay::Use imu;
  std::string imu_frame;

  Settings(Params params, const std::string& name_space) {
    worker.lcm_url = params.text("lcm_url");
    const std::string key_file = params.text("key_file");
    worker.vehicle_id = params.textOr("vehicle_id", link::DEFAULT_VEHICLE_ID);
    const std::string vehicle_file = params.textOr("vehicle_file", "");
    if (!vehicle_file.empty()) worker.throttle = vehicle::throttleScaleOf(vehicle_file);
    worker.heartbeat_period = params.number("heartbeat_period", {0.01, 0.05}, "s");
    worker.pulse_age = params.number("command_age", {0.02, 0.1}, "s");
    worker.request_age = params.number("request_age", {0.1, 1.0}, "s");
    worker.spin_timeout = params.number("spin_timeout", {0.05, 0.2}, "s");
    worker.deadman_topic = params.choice("deadman", {"service", "topic"}) == "topic";
    worker.deadman_timeout = params.number("deadman_timeout", {0.05, 0.2}, "s");
    worker.times.arm_timeout = params.number("arm_timeout", {0.2, 5.0}, "s");
    diagnostic_interval = params.number("diagnostic_interval", {0.1, 5.0}, "s");
    const std::string use = params.textOr("imu", "auto");
    if (use != "auto" && use != "on" && use != "off")
      throw common::SettingError("flight_link_node", "imu", use, "auto, on or off");
    imu = use == "on" ? ImuRelay::Use::ON : use == "off" ? ImuRelay::Use::OFF : ImuRelay::Use::AUTO;
    imu_frame = framePrefix(params, name_space) + params.textOr("imu_frame", "housing");
    params.finish();
    worker.key = link::loadKeyFile(key_file);
  }
};

void log(LinkWorker::Level level, const std::string& line) {
  if (level == LinkWorker::Level::INFO) ROS_INFO_STREAM(line);
  if (level == LinkWorker::Level::WARN) ROS_WARN_STREAM(line);
  if (level == LinkWorker::Level::ERROR) ROS_ERROR_STREAM(line);
}

}  // namespace

class FlightLinkNode {
 public:
  using Request = link::ArmingProtocol::Request;

  explicit FlightLinkNode(Handles& handles)
      : settings_(Params::fromServer(handles.own), handles.relative.getNamespace()),
        imu_(handles.relative, settings_.imu, settings_.imu_frame),
        publisher_(handles.relative.advertise<LinkStatus>(topics::LINK_STATUS, 10)),
        worker_(
            settings_.worker,
            [this](const link::BridgeStatus& status, const link::OperatorLink& link) {
              publisher_.publish(toMessage(status, link));
            },
            [this](const snapwing_lcm::telemetry_t& telemetry) { imu_.pass(telemetry); }, log),
        diagnostics_(worker_, settings_.diagnostic_interval) {
    const ros::TransportHints at_once = ros::TransportHints().tcpNoDelay();
    ros::NodeHandle& nh = handles.relative;
    pulses_ = nh.subscribe(topics::COMMAND_PULSE, 4, &FlightLinkNode::onPulse, this, at_once);
    diagnostic_timer_ = nh.createWallTimer(ros::WallDuration(settings_.diagnostic_interval),
                                           [this](const ros::WallTimerEvent&) { diagnostics_.update(); });
    ros::NodeHandle urgent(nh), patient(nh);
    urgent.setCallbackQueue(&urgent_queue_);
    patient.setCallbackQueue(&patient_queue_);
    if (settings_.worker.deadman_topic) {
      deadman_ = urgent.subscribe(COMMAND_DEADMAN, 1, &FlightLinkNode::onDeadman, this, at_once);
    }
    services_.push_back(urgent.advertiseService(ABORT, &FlightLinkNode::abort, this));
    services_.push_back(patient.advertiseService(topics::ARM, &FlightLinkNode::arm, this));
    services_.push_back(patient.advertiseService(topics::RESET_LINK, &FlightLinkNode::reset, this));
    for (int i = 0; i < URGENT_THREADS; ++i) threads_.emplace_back([this] { spin(urgent_queue_, true); });
    threads_.emplace_back([this] { spin(patient_queue_, false); });
    link::leaveRealtimePriority();  // of the thread that spins; ROS's own threads and ours have theirs
  }

  ~FlightLinkNode() {
    stop_ = true;
    for (std::thread& thread : threads_) thread.join();
    services_.clear();
    deadman_.shutdown();
  }

 private:
  /// @param urgent  coming round is the sign that an abort would be taken
  void spin(ros::CallbackQueue& queue, bool urgent) {
    while (!stop_) {
      queue.callAvailable(ros::WallDuration(SPIN_PERIOD));
      if (urgent) worker_.noteAlive();
    }
  }

  void onDeadman(const std_msgs::Bool& message) { worker_.setDeadman(message.data); }

  void onPulse(const PulseCommand& command) { worker_.pulse(command.id, shapeOf(command), fromMessage(command.seal)); }

  template <class Response>
  bool carryOut(const char* what, Request request, const link::CommandSeal& seal, Response& response) {
    const link::ArmingAnswer answer = worker_.carryOut(request, seal);
    response.success = answer.success;
    response.message = answer.message;
    ROS_INFO_STREAM(what << ": " << response.message);
    return true;
  }

  bool arm(Arm::Request& request, Arm::Response& response) {
    const Request what = request.data ? Request::ARM : Request::DISARM;
    return carryOut(request.data ? "arm" : "disarm", what, fromMessage(request.seal), response);
  }

  bool reset(ResetLink::Request& request, ResetLink::Response& response) {
    return carryOut("reset", Request::RESET, fromMessage(request.seal), response);
  }

  bool abort(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
    return carryOut("abort", Request::ABORT, {}, response);
  }

  Settings settings_;
  ImuRelay imu_;
  ros::Publisher publisher_;
  LinkWorker worker_;
  LinkDiagnostics diagnostics_;
  ros::CallbackQueue urgent_queue_, patient_queue_;
  ros::Subscriber pulses_, deadman_;
  std::vector<ros::ServiceServer> services_;
  ros::WallTimer diagnostic_timer_;
  std::atomic<bool> stop_{false};
  std::vector<std::thread> threads_;
};

}  // namespace snapwing::nodes

int main(int argc, char** argv) {
  // Before ROS starts its threads, which inherit it: a busy machine must not hold up an abort.
  snapwing::link::takeRealtimePriority(snapwing::link::OPERATOR_PRIORITY);
  return snapwing::nodes::runNode<snapwing::nodes::FlightLinkNode>(argc, argv, "flight_link_node");
}
