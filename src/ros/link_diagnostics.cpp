#include "link_diagnostics.h"

namespace snapwing::nodes {
namespace {

using Level = diagnostic_msgs::DiagnosticStatus;

std::string listed(const link::Histogram& histogram) {
  std::string text;
  for (const std::int64_t count : histogram) text += (text.empty() ? "" : " ") + std::to_string(count);
  return text;
}

}  // namespace

LinkStatus toMessage(const link::BridgeStatus& status, const link::OperatorLink& link) {
  LinkStatus message;
  message.header.stamp = ros::Time::now();
  message.vehicle_id = link.vehicleId();
  message.session = link.session();
  message.number = status.number;
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
  if (!link.telemetryKnown()) return message;
  const snapwing_lcm::telemetry_t& telemetry = link.telemetry();
  for (int i = 0; i < telemetry.motor_count && i < 8; ++i) {
    if (telemetry.motors[i] > 0) message.motors.push_back(static_cast<std::uint16_t>(telemetry.motors[i]));
  }
  return message;
}

LinkDiagnostics::LinkDiagnostics(const LinkWorker& worker, double interval) : worker_(worker), interval_(interval) {
  updater_.setHardwareID("flight controller");
  updater_.add("link", this, &LinkDiagnostics::diagnoseLink);
  updater_.add("controller", this, &LinkDiagnostics::diagnoseController);
}

void LinkDiagnostics::diagnoseLink(Wrapper& out) {
  const LinkSnapshot now = worker_->snapshot();
  const link::BridgeStatus& status = now.status;
  const double rate = static_cast<double>(now.counters.statuses - last_.statuses) / interval_;
  const bool losing = now.counters.missed > last_.missed || now.counters.rejected > last_.rejected;
  last_ = now.counters;
  if (!(now.status_age < link::OperatorLink::BRIDGE_TIMEOUT)) {
    out.summary(Level::ERROR, "no radio bridge heard" + (now.hint.empty() ? "" : "; " + now.hint));
  } else if (status.state == link::BridgeState::FAULT) {
    out.summary(Level::ERROR, "fault: " + link::describe(status.fault, status.fault_detail));
  } else if (!now.hint.empty()) {
    out.summary(Level::WARN, now.hint);
  } else if (losing) {
    out.summary(Level::WARN, "messages lost or rejected");
  } else {
    out.summary(Level::OK, link::stateName(status.state));
  }
  out.addf("status age [s]", "%.3f", now.status_age);
  out.addf("status rate [Hz]", "%.1f", rate);
  out.add("statuses received", now.counters.statuses);
  out.add("statuses missed", now.counters.missed);
  out.add("statuses that answer nobody (recorded?)", now.counters.unproven);
  out.add("messages rejected here", now.counters.rejected);
  out.add("messages rejected by the bridge", now.rejected_by_bridge);
  out.add("commands accepted", status.commands_accepted);
  out.add("commands refused", status.commands_refused);
  out.add("commands refused here", now.refused_here);
  out.add("frames sent", status.frames_sent);
  out.add("frames dropped", status.frames_dropped);
  out.addf("worst frame period [s]", "%.4f", status.period_worst);
  out.addf("worst command latency [s]", "%.4f", status.latency_worst);
  out.add("frames late by < .1 .2 .5 1 2 5 10 20 50 ms, more", listed(status.period_histogram));
  out.add("commands to frame < .1 .2 .5 1 2 5 10 20 50 ms, more", listed(status.latency_histogram));
  out.add("real-time priority", status.realtime);
  out.add("memory locked", status.memory_locked);
}

void LinkDiagnostics::diagnoseController(Wrapper& out) {
  const LinkSnapshot now = worker_->snapshot();
  const link::ControllerState& controller = now.status.controller;
  const snapwing_lcm::telemetry_t& telemetry = now.telemetry;
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
  out.addf("telemetry age [s]", "%.3f", now.status.telemetry_age);
  out.add("pilot's override switch held", controller.override_active);
  out.addf("interface version", "%d.%d", telemetry.api_major, telemetry.api_minor);
  out.add("variant", std::string(reinterpret_cast<const char*>(telemetry.variant), 4).c_str());
  out.addf("failsafe delay [s]", "%.1f", telemetry.failsafe_delay);
  out.add("failsafe procedure", telemetry.failsafe_procedure);
  out.add("answers", telemetry.replies);
  out.add("bad answers", telemetry.reply_errors);
}

}  // namespace snapwing::nodes
