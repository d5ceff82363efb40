/// transition_planner_node: action switch_mode. Plans a pulse in a thread of its own, publishes the plan, checks that
/// link and mode are ready, commands the pulse once, and waits until the estimated mode tells how it ended. Safety does
/// not rest on it: the radio bridge ends every pulse by its own clock.

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
#include <cmath>
#include <future>
#include <limits>
#include <map>
#include <mutex>

#include "snapwing/common/table_origin.h"
#include "snapwing/planning/pulse_planner.h"
#include "snapwing/ros/conversions.h"
#include "snapwing/ros/node_main.h"
#include "snapwing/ros/planning_conversions.h"
#include "snapwing/ros/seal_conversions.h"
#include "snapwing/ros/topics.h"

namespace snapwing::nodes {

namespace {

struct SwitchSettings {
  double fresh = 0;           ///< [s] link status and mode estimate older than this count as lost
  double accept_timeout = 0;  ///< [s] the bridge must have taken the pulse within this time
  double settle_timeout = 0;  ///< [s] after the pulse's end
  double settle_hold = 0;     ///< [s] the estimate must stay in one mode for this long
  std::string key_file;       ///< of the link; empty = plans only
  std::string vehicle_id;
};

SwitchSettings readSwitch(Params& params) {
  SwitchSettings s;
  s.fresh = params.number("fresh", {0.05, 5.0}, "s");
  s.accept_timeout = params.number("accept_timeout", {0.05, 5.0}, "s");
  s.settle_timeout = params.number("settle_timeout", {0.1, 30.0}, "s");
  s.settle_hold = params.number("settle_hold", {0.0, 5.0}, "s");
  s.key_file = params.textOr("key_file", "");
  s.vehicle_id = params.textOr("vehicle_id", link::DEFAULT_VEHICLE_ID);
  return s;
}

planning::PlannerSettings readPlanner(Params& params) {
  planning::PlannerSettings s;
  s.throttle_min = params.number("throttle_min", {0.0, 1.0}, "1");
  s.throttle_max = params.number("throttle_max", {0.0, 1.0}, "1");
  s.duration_min = params.number("duration_min", {0.0, 5.0}, "s");
  s.duration_max = params.number("duration_max", {0.0, 5.0}, "s");
  s.search_samples = params.integer("search_samples", 0, 100000);
  s.verify_samples = params.integer("verify_samples", 1, 1000000);
  s.refine_evaluations = params.integer("refine_evaluations", 0, 100000);
  s.required_margin = params.number("required_margin", {-1.0, 10.0}, "1");
  s.required_share = params.number("required_share", {0.0, 1.0}, "1");
  s.threads = params.integer("threads", 1, 64);
  s.validate();
  return s;
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
    const common::ForceTable table = common::armTableOf(vehicle_);
    return {vehicle_, table, readPlanner(params), common::wingTableOf(vehicle_, table)};
  }

  TransitionPlannerNode(Handles& handles, Params params)
      : vehicle_(params.vehicle()),
        trial_(readTrial(params, vehicle_)),
        settings_(readSwitch(params)),
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
    const std::lock_guard<std::mutex> lock(mutex_);
    link_ = message;
    link_time_ = ros::Time::now();
  }

  void onMode(const ModeState& message) {
    const std::lock_guard<std::mutex> lock(mutex_);
    mode_ = message;
    mode_time_ = ros::Time::now();
  }

  LinkStatus link() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return link_;
  }

  /// Estimated mode; UNKNOWN if the estimate is old.
  common::Mode mode() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    const bool old = mode_time_.isZero() || ros::Time::now() - mode_time_ > ros::Duration(settings_.fresh);
    return old ? common::Mode::UNKNOWN : modeFromMessage(mode_.mode);
  }

  double probability(common::Mode mode) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return mode == common::Mode::FIXED_WING ? mode_.probability_fixed_wing : mode_.probability_quadrotor;
  }

  /// Why the link cannot carry a pulse now; empty if it can.
  std::string linkTrouble() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (link_time_.isZero()) return "no link status was ever received";
    if (ros::Time::now() - link_time_ > ros::Duration(settings_.fresh))
      return "the link status stopped: is the radio bridge running?";
    if (link_.bridge_state == LinkStatus::BRIDGE_FAULT)
      return "the radio bridge latched a fault: " + link_.bridge_fault;
    if (!link_.controller_connected) return "the flight controller does not answer";
    if (link_.controller_failsafe) return "the flight controller is in failsafe";
    if (!link_.controller_armed) return "the flight controller is not armed";
    return "";
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
    const common::Mode target = modeFromMessage(goal.target_mode);
    if (target == common::Mode::UNKNOWN) {
      finish(result, Result::NOT_READY, "the target mode must be 1 (fixed wing) or 2 (quadrotor)");
      return;
    }
    const common::Mode start = common::otherMode(target);
    if (!plan(start, target, result)) return;
    if (goal.plan_only) {
      finish(result, Result::SUCCEEDED, "planned only");
      return;
    }
    if (!ready(start, result)) return;
    const ros::Time commanded = ros::Time::now();
    if (!sendPulse(commanded, target, result)) return;
    settle(commanded, target, result);
  }

  bool preempted() { return server_.isPreemptRequested() || !ros::ok(); }

  void report(std::uint8_t stage, const ros::Time& since, common::Mode target) {
    Feedback feedback;
    feedback.stage = stage;
    feedback.elapsed = (ros::Time::now() - since).toSec();
    feedback.probability_target = probability(target);
    server_.publishFeedback(feedback);
  }

  /// An accepted plan for the same question is taken from memory: planning is deterministic.
  bool plan(common::Mode start, common::Mode target, Result& result) {
    const ros::Time since = ros::Time::now();
    if (!plans_.count(target)) {
      std::future<planning::TransitionPlan> answer = std::async(
          std::launch::async, [&] { return planner_.plan(start, target, trial_, [this] { return preempted(); }); });
      while (answer.wait_for(std::chrono::milliseconds(100)) != std::future_status::ready) {
        report(Feedback::PLANNING, since, target);
      }
      planning::TransitionPlan found = answer.get();
      found.compute_seconds = (ros::Time::now() - since).toSec();
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
    const LinkStatus heard = link();
    const link::CommandSealer sealer(key_, settings_.vehicle_id);
    command.seal = toMessage(sealer.seal(link::pulseContent(command.id, command.pulse.throttle, command.pulse.duration,
                                                            command.mixed != 0, command.pitch),
                                         heard.session, heard.number));
  }

  bool ready(common::Mode start, Result& result) {
    if (settings_.key_file.empty()) {
      return finish(result, Result::NOT_READY, "no key_file is given: pulses cannot be sealed, this node plans only");
    }
    key_ = link::loadKeyFile(settings_.key_file);
    const std::string trouble = linkTrouble();
    if (!trouble.empty()) return finish(result, Result::NOT_READY, trouble);
    if (link().bridge_state != LinkStatus::BRIDGE_ARMED) {
      return finish(result, Result::NOT_READY, "the radio bridge is not ready for a pulse");
    }
    const common::Mode now = mode();
    if (now == start) return true;
    return finish(result, Result::NOT_READY,
                  now == common::Mode::UNKNOWN ? "the mode is not known" : "the vehicle is already in the target mode");
  }

  /// Commands the pulse and watches the link until its end.
  bool sendPulse(const ros::Time& commanded, common::Mode target, Result& result) {
    PulseCommand command;
    command.header.stamp = commanded;
    // Ids go on counting up over restarts of this node.
    last_id_ = std::max(last_id_ + 1, commanded.sec);
    command.id = last_id_;
    command.pulse = result.plan.pulse;
    const LinkStatus before = link();
    ros::WallTime next_publication;
    ros::Rate rate(50);
    for (bool accepted = false;; rate.sleep()) {
      // A seal holds for a tenth of a second only: on a busy machine the first may come too late. The link takes an id
      // only once.
      if (!accepted && ros::WallTime::now() >= next_publication) {
        seal(command);
        pulse_publisher_.publish(command);
        next_publication = ros::WallTime::now() + ros::WallDuration(0.06);
      }
      const double elapsed = (ros::Time::now() - commanded).toSec();
      const std::string trouble = linkTrouble();
      if (!trouble.empty()) return finish(result, Result::LINK_LOST, trouble);
      if (preempted()) return finish(result, Result::PREEMPTED, "preempted while the pulse ran; the bridge ends it");
      const LinkStatus now = link();
      accepted = accepted || now.pulse_id == command.id;
      if (!accepted && now.commands_refused > before.commands_refused) {
        return finish(result, Result::NOT_READY, "the link refused the pulse: " + now.last_refusal);
      }
      if (!accepted && elapsed > settings_.accept_timeout) {
        return finish(result, Result::LINK_LOST, "the radio bridge did not take the pulse");
      }
      if (accepted && elapsed > command.pulse.duration && now.bridge_state != LinkStatus::BRIDGE_PULSE) return true;
      report(Feedback::PULSE, commanded, target);
    }
  }

  /// Waits until the estimate has stayed in one mode for settle_hold; a stay in the mode left behind counts only at the
  /// end of the time, since the vehicle may still be on its way.
  void settle(const ros::Time& commanded, common::Mode target, Result& result) {
    const ros::Time since = ros::Time::now();
    ros::Rate rate(50);
    ros::Time reached;
    while ((ros::Time::now() - since).toSec() < settings_.settle_timeout) {
      if (preempted()) {
        finish(result, Result::PREEMPTED, "preempted while settling");
        return;
      }
      const std::string trouble = linkTrouble();
      if (!trouble.empty()) {
        finish(result, Result::LINK_LOST, trouble);
        return;
      }
      const bool there = mode() == target;
      if (there && reached.isZero()) reached = ros::Time::now();
      if (!there) reached = ros::Time();
      if (there && (ros::Time::now() - reached).toSec() >= settings_.settle_hold) {
        result.switch_seconds = (reached - commanded).toSec();
        finish(result, Result::SUCCEEDED, "switched");
        return;
      }
      report(Feedback::SETTLING, commanded, target);
      rate.sleep();
    }
    const bool other = mode() == common::otherMode(target);
    finish(result, other ? Result::WRONG_MODE : Result::NOT_SETTLED,
           other ? "the vehicle settled in the mode that it started from" : "the mode did not become known in time");
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

  common::Vehicle vehicle_;
  rom::Trial trial_;
  SwitchSettings settings_;
  planning::PulsePlanner planner_;
  std::map<common::Mode, TransitionPlan> plans_;  ///< accepted ones, by target
  std::uint32_t last_id_ = 0;
  link::Key key_{};
  mutable std::mutex mutex_;  ///< guards what follows
  LinkStatus link_;
  ModeState mode_;
  ros::Time link_time_, mode_time_;
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
