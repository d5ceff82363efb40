/// transition_planner_node: action switch_mode. Plans a pulse in a thread of its own, publishes the plan, and carries
/// the messages of planning/switch_protocol.h, which decides what a switch does. Safety does not rest on it: the radio
/// bridge ends every pulse by its own clock.

#include <actionlib/server/simple_action_server.h>
#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/console.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>
#include <ros/timer.h>
#include <snapwing/LinkStatus.h>
#include <snapwing/ModeState.h>
#include <snapwing/PulseCommand.h>
#include <snapwing/SwitchModeAction.h>

#include <algorithm>
#include <future>
#include <limits>
#include <map>
#include <mutex>

#include "clocks.h"
#include "conversions.h"
#include "node_main.h"
#include "planning_conversions.h"
#include "seal_conversions.h"
#include "snapwing/common/time_watch.h"
#include "snapwing/planning/pulse_planner.h"
#include "snapwing/planning/switch_protocol.h"
#include "snapwing/vehicle/table_origin.h"
#include "topics.h"

namespace snapwing::nodes {

namespace {

// A seal holds for a tenth of a second, and on a busy machine the first may come too late: a pulse that nobody has
// taken is sealed anew for a while, under its id, which the link takes only once.
constexpr double SEAL_PERIOD = 0.06;    // [s]
constexpr double LAST_SEAL = 0.25;      // [s] before accept_timeout
constexpr double COMMAND_MARGIN = 0.1;  // [s] before accept_timeout, by which the last of them is too old to be taken

planning::SwitchSettings readSwitch(Params& params) {
  planning::SwitchSettings s;
  s.fresh = params.number("fresh", {0.05, 5.0}, "s");
  s.accept_timeout = params.number("accept_timeout", {0.3, 5.0}, "s");
  s.settle_timeout = params.number("settle_timeout", {0.1, 30.0}, "s");
  s.settle_hold = params.number("settle_hold", {0.0, 5.0}, "s");
  s.command_life = s.accept_timeout - COMMAND_MARGIN;
  s.attempts = params.integer("attempts", 1, 5);
  s.validate();
  return s;
}

planning::PlannerSettings readPlanner(Params& params) {
  planning::PlannerSettings s;
  s.throttle_min = params.number("throttle_min", {0.0, 1.0}, "1");
  s.throttle_max = params.number("throttle_max", {0.0, 1.0}, "1");
  s.duration_min = params.number("duration_min", {0.0, 5.0}, "s");
  s.duration_max = params.number("duration_max", {0.0, 5.0}, "s");
  s.hold_throttle = params.number("hold_throttle", {0.0, 1.0}, "1");
  s.hold_duration = params.number("hold_duration", {0.0, 5.0}, "s");
  s.search_samples = params.integer("search_samples", 0, 100000);
  s.verify_samples = params.integer("verify_samples", 1, 1000000);
  s.refine_evaluations = params.integer("refine_evaluations", 0, 100000);
  s.required_margin = params.number("required_margin", {-1.0, 10.0}, "1");
  s.required_share = params.number("required_share", {0.0, 1.0}, "1");
  s.threads = params.integer("threads", 1, 64);
  s.validate();
  return s;
}

planning::SwitchView::Bridge bridgeOf(const LinkStatus& link) {
  using Bridge = planning::SwitchView::Bridge;
  switch (link.bridge_state) {
    case LinkStatus::BRIDGE_IDLE:
      return Bridge::IDLE;
    case LinkStatus::BRIDGE_ARMED:
      return Bridge::ARMED;
    case LinkStatus::BRIDGE_PULSE:
      return Bridge::PULSE;
    case LinkStatus::BRIDGE_FAULT:
      return Bridge::FAULT;
    default:
      return Bridge::UNKNOWN;
  }
}

std::uint8_t codeOf(planning::SwitchOutcome outcome) {
  using Outcome = planning::SwitchOutcome;
  switch (outcome) {
    case Outcome::SUCCEEDED:
      return SwitchModeResult::SUCCEEDED;
    case Outcome::LINK_LOST:
      return SwitchModeResult::LINK_LOST;
    case Outcome::WRONG_MODE:
      return SwitchModeResult::WRONG_MODE;
    case Outcome::NOT_SETTLED:
      return SwitchModeResult::NOT_SETTLED;
    case Outcome::PREEMPTED:
      return SwitchModeResult::PREEMPTED;
    default:
      return SwitchModeResult::NOT_READY;
  }
}

}  // namespace

class TransitionPlannerNode {
 public:
  using Server = actionlib::SimpleActionServer<SwitchModeAction>;
  using Result = SwitchModeResult;
  using Feedback = SwitchModeFeedback;

  explicit TransitionPlannerNode(Handles& handles) : TransitionPlannerNode(handles, Params::fromServer(handles.own)) {}

 private:
  planning::PulsePlanner makePlanner(Params& params) const {
    const vehicle::ForceTable table = vehicle::armTableOf(vehicle_);
    return {vehicle_, table, readPlanner(params), vehicle::wingTableOf(vehicle_, table)};
  }

  TransitionPlannerNode(Handles& handles, Params params)
      : vehicle_(params.vehicle()),
        trial_(readTrial(params, vehicle_)),
        taken_over_(params.number("final_thrust", {0.0, 1.0}, "1")),
        settings_(readSwitch(params)),
        key_file_(params.textOr("key_file", "")),
        vehicle_id_(params.textOr("vehicle_id", link::DEFAULT_VEHICLE_ID)),
        planner_(makePlanner(params)),
        server_(
            handles.relative, topics::SWITCH_MODE, [this](const SwitchModeGoalConstPtr& goal) { onGoal(*goal); },
            false) {
    params.finish();
    ros::NodeHandle& nh = handles.relative;
    plan_publisher_ = nh.advertise<TransitionPlan>(topics::TRANSITION_PLAN, 4, true);
    pulse_publisher_ = nh.advertise<PulseCommand>(topics::COMMAND_PULSE, 1);
    link_subscriber_ = nh.subscribe(topics::LINK_STATUS, 10, &TransitionPlannerNode::onLink, this);
    mode_subscriber_ = nh.subscribe(topics::MODE_STATE, 10, &TransitionPlannerNode::onMode, this);
    diagnostics_.setHardwareID(vehicle_.name);
    diagnostics_.add("last switch", this, &TransitionPlannerNode::diagnose);
    timer_ = nh.createTimer(ros::Duration(0.5), [this](const ros::TimerEvent&) { diagnostics_.update(); });
    server_.start();
  }

  void onLink(const LinkStatus& message) {
    const Clocks clocks = Clocks::read();
    const std::lock_guard<std::mutex> lock(mutex_);
    lookAtClock(clocks);
    const double stamp = message.header.stamp.toSec();
    if (link_watch_.take(stamp, clocks.now, clocks.steady) == common::StampVerdict::GOOD) link_ = message;
  }

  void onMode(const ModeState& message) {
    const Clocks clocks = Clocks::read();
    const std::lock_guard<std::mutex> lock(mutex_);
    lookAtClock(clocks);
    const double stamp = message.header.stamp.toSec();
    if (mode_watch_.take(stamp, clocks.now, clocks.steady) == common::StampVerdict::GOOD) mode_ = message;
  }

  /// After a jump of the clock nothing that came before counts. With the mutex held.
  void lookAtClock(const Clocks& clocks) {
    const common::ClockEvent event = clock_.look(clocks.now, clocks.steady);
    if (event != common::ClockEvent::BACK && event != common::ClockEvent::AHEAD) return;
    link_watch_.restart();
    mode_watch_.restart();
  }

  /// What is known now.
  planning::SwitchView view() {
    const bool stop = preempted();
    const Clocks clocks = Clocks::read();
    const std::lock_guard<std::mutex> lock(mutex_);
    lookAtClock(clocks);
    const double fresh = settings_.fresh;
    planning::SwitchView view;
    view.now = clocks.steady;
    view.stop_asked = stop;
    view.link_age = link_watch_.age(clocks.now, clocks.steady);
    view.link_trouble = link_watch_.trouble(clocks.now, clocks.steady, fresh);
    view.bridge = bridgeOf(link_);
    view.bridge_fault = link_.bridge_fault;
    view.controller_connected = link_.controller_connected;
    view.controller_armed = link_.controller_armed;
    view.controller_failsafe = link_.controller_failsafe;
    view.pulse_id = link_.pulse_id;
    view.refused = link_.commands_refused;
    view.last_refusal = link_.last_refusal;
    view.mode_age = mode_watch_.age(clocks.now, clocks.steady);
    view.mode_trouble = mode_watch_.trouble(clocks.now, clocks.steady, fresh);
    view.mode = modeFromMessage(mode_.mode);
    view.mode_reason = mode_.reason;
    view.reading_age = mode_.reading_age + view.mode_age;
    return view;
  }

  LinkStatus newestLink() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return link_;
  }

  /// Estimated mode; UNKNOWN if the estimate is old.
  vehicle::Mode mode() {
    const planning::SwitchView now = view();
    return now.mode_age <= settings_.fresh ? now.mode : vehicle::Mode::UNKNOWN;
  }

  double probability(vehicle::Mode mode) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return mode == vehicle::Mode::FIXED_WING ? mode_.probability_fixed_wing : mode_.probability_quadrotor;
  }

  void onGoal(const SwitchModeGoal& goal) {
    Result result;
    result.switch_seconds = std::numeric_limits<double>::quiet_NaN();
    try {
      execute(goal, result);
    } catch (const std::exception& error) {
      finish(result, Result::NOT_READY, error.what());
    }
    result.final_mode = toMessage(mode());
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      last_result_ = result;
      ++switches_;
    }
    if (result.code == Result::SUCCEEDED) {
      server_.setSucceeded(result, result.message);
    } else if (result.code == Result::PREEMPTED) {
      server_.setPreempted(result, result.message);
    } else {
      ROS_WARN_STREAM("switch_mode: " << result.message);
      server_.setAborted(result, result.message);
    }
  }

  static bool finish(Result& result, std::uint8_t code, const std::string& message) {
    result.code = code;
    result.message = message;
    return false;
  }

  void execute(const SwitchModeGoal& goal, Result& result) {
    const vehicle::Mode target = modeFromMessage(goal.target_mode);
    if (target == vehicle::Mode::UNKNOWN) {
      finish(result, Result::NOT_READY, "the target mode must be 1 (fixed wing) or 2 (quadrotor)");
      return;
    }
    if (!goal.plan_only) {  // a switch that cannot begin is refused at once, not after the planning
      auto missing = planning::SwitchProtocol::missing(settings_, view(), target);
      if (key_file_.empty()) missing.push_back("a key_file: pulses cannot be sealed, this node plans only");
      if (missing.empty()) key_ = link::loadKeyFile(key_file_);
      if (!missing.empty()) {
        finish(result, Result::NOT_READY, planning::SwitchProtocol::missingText(missing));
        return;
      }
    }
    if (!plan(vehicle::otherMode(target), target, result)) return;
    if (goal.plan_only) {
      finish(result, Result::SUCCEEDED, "planned only");
      return;
    }
    carryOut(target, result);
  }

  vehicle::Trial trialTo(vehicle::Mode target) const {
    vehicle::Trial trial = trial_;
    if (target == vehicle::Mode::QUADROTOR && taken_over_ > 0) trial.final_thrust_fraction = taken_over_;
    return trial;
  }

  bool preempted() { return server_.isPreemptRequested() || !ros::ok(); }

  void report(std::uint8_t stage, double since, vehicle::Mode target) {
    Feedback feedback;
    feedback.stage = stage;
    feedback.elapsed = Clocks::read().steady - since;
    feedback.probability_target = probability(target);
    server_.publishFeedback(feedback);
  }

  /// An accepted plan for the same question is taken from memory: planning is deterministic. Reports ten times a second
  /// while it computes, however long that takes.
  bool plan(vehicle::Mode start, vehicle::Mode target, Result& result) {
    const double since = Clocks::read().steady;
    if (!plans_.count(target)) {
      std::future<planning::TransitionPlan> answer = std::async(std::launch::async, [&] {
        return planner_.plan(start, target, trialTo(target), [this] { return preempted(); });
      });
      while (answer.wait_for(std::chrono::milliseconds(100)) != std::future_status::ready) {
        report(Feedback::PLANNING, since, target);
      }
      planning::TransitionPlan found = answer.get();
      found.compute_seconds = Clocks::read().steady - since;
      if (preempted()) return finish(result, Result::PREEMPTED, "preempted while planning");
      result.plan = toMessage(found);
      if (found.accepted) plans_[target] = result.plan;
    } else {
      result.plan = plans_[target];
    }
    result.plan.header.stamp = ros::Time::now();
    plan_publisher_.publish(result.plan);
    return result.plan.accepted || finish(result, Result::REFUSED, "no safe pulse: " + result.plan.reason);
  }

  void seal(PulseCommand& command) {
    const LinkStatus heard = newestLink();
    const link::CommandSealer sealer(key_, vehicle_id_);
    command.seal =
        toMessage(sealer.seal(link::pulseContent(command.id, shapeOf(command)), heard.session, heard.number));
  }

  /// Does what the protocol says, fifty times a second.
  void carryOut(vehicle::Mode target, Result& result) {
    // Ids go on counting up over restarts of this node.
    const std::uint32_t first_id = std::max(last_id_ + 1, ros::Time::now().sec);
    planning::SwitchProtocol protocol(settings_, target, fromMessage(result.plan.pulse).whole(), first_id);
    const double since = Clocks::read().steady;
    double sent = 0, published = 0;
    for (ros::WallRate rate(50);; rate.sleep()) {
      const planning::SwitchAction action = protocol.step(view());
      last_id_ = protocol.id();
      if (action == planning::SwitchAction::FINISH) break;
      const double now = Clocks::read().steady;
      if (action == planning::SwitchAction::SEND) sent = now, published = -1;
      const bool waits = protocol.state() == planning::SwitchState::SENT;
      if (waits && now - published >= SEAL_PERIOD && now - sent <= settings_.accept_timeout - LAST_SEAL) {
        sendPulse(protocol.id(), result.plan.pulse);
        published = now;
      }
      const bool settling = protocol.state() == planning::SwitchState::SETTLING;
      report(settling ? Feedback::SETTLING : Feedback::PULSE, since, target);
    }
    result.switch_seconds = protocol.switchSeconds();
    finish(result, codeOf(protocol.outcome()), protocol.message());
  }

  void sendPulse(std::uint32_t id, const ThrustPulse& pulse) {
    PulseCommand command;
    command.header.stamp = ros::Time::now();
    command.id = id;
    command.pulse = pulse;
    seal(command);
    pulse_publisher_.publish(command);
  }

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
    using diagnostic_msgs::DiagnosticStatus;
    const std::lock_guard<std::mutex> lock(mutex_);
    if (switches_ == 0) {
      status.summary(DiagnosticStatus::OK, "nothing asked yet");
      return;
    }
    status.summary(last_result_.code == Result::SUCCEEDED ? DiagnosticStatus::OK : DiagnosticStatus::WARN,
                   last_result_.message);
    status.add("goals", switches_);
    status.add("planning time [s]", last_result_.plan.compute_seconds);
    status.add("worst margin", last_result_.plan.worst_margin);
    status.add("switch time [s]", last_result_.switch_seconds);
  }

  vehicle::Vehicle vehicle_;
  vehicle::Trial trial_;
  double taken_over_;  ///< [1] thrust at which somebody else leads after a switch to Q; 0 = motors idle
  planning::SwitchSettings settings_;
  std::string key_file_;  ///< of the link; empty = plans only
  std::string vehicle_id_;
  planning::PulsePlanner planner_;
  std::map<vehicle::Mode, TransitionPlan> plans_;  ///< accepted ones, by target
  std::uint32_t last_id_ = 0;
  link::Key key_{};
  mutable std::mutex mutex_;  ///< guards what follows
  LinkStatus link_;
  ModeState mode_;
  common::ClockWatch clock_;
  common::StampWatch link_watch_, mode_watch_;
  Result last_result_;
  unsigned switches_ = 0;
  ros::Publisher plan_publisher_, pulse_publisher_;
  ros::Subscriber link_subscriber_, mode_subscriber_;
  diagnostic_updater::Updater diagnostics_;
  ros::Timer timer_;
  Server server_;
};

}  // namespace snapwing::nodes

int main(int argc, char** argv) {
  return snapwing::nodes::runNode<snapwing::nodes::TransitionPlannerNode>(argc, argv, "transition_planner_node");
}
