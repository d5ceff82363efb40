#include "lcm_messages.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "snapwing/link/clock.h"

namespace snapwing::link {
namespace {

constexpr double MICRO = 1e-6;
constexpr std::int32_t VERSION = snapwing_lcm::stamp_t::VERSION;

void copyChannels(const Channels& in, std::int16_t* out, std::size_t capacity) {
  for (std::size_t i = 0; i < capacity; ++i) {
    out[i] = static_cast<int>(i) < in.count ? static_cast<std::int16_t>(in.us[i]) : std::int16_t{0};
  }
}

}  // namespace

bool fromLcm(const snapwing_lcm::stamp_t& in, Stamp& out) {
  if (in.version != VERSION || in.expiry_us <= 0) return false;
  out.sender_id = in.sender_id;
  out.session = in.session;
  out.number = in.number;
  out.time = MICRO * static_cast<double>(in.status_utime);
  out.status_number = in.status_number;
  out.held = MICRO * in.held_us;
  out.expiry = MICRO * in.expiry_us;
  return true;
}

snapwing_lcm::stamp_t toLcm(const Stamp& in) {
  snapwing_lcm::stamp_t out{};
  out.version = VERSION;
  out.utime = wallMicroseconds();
  out.sender_id = in.sender_id;
  out.session = in.session;
  out.number = in.number;
  out.status_number = in.status_number;
  out.status_utime = std::llround(in.time / MICRO);
  out.held_us = static_cast<std::int32_t>(std::lround(std::clamp(in.held, -2e3, 2e3) / MICRO));
  out.expiry_us = static_cast<std::int32_t>(std::lround(in.expiry / MICRO));
  return out;
}

bool fromLcm(const snapwing_lcm::pulse_command_t& in, PulseCommand& out) {
  out.pulse_id = in.pulse_id;
  out.throttle = in.throttle;
  out.duration = in.duration;
  out.hold_throttle = in.hold_throttle;
  out.hold_duration = in.hold_duration;
  out.pitch = in.pitch;
  out.mixed = in.mixed != 0;
  return fromLcm(in.stamp, out.stamp);
}

snapwing_lcm::pulse_command_t toLcm(const PulseCommand& in) {
  snapwing_lcm::pulse_command_t out{};
  out.stamp = toLcm(in.stamp);
  out.pulse_id = in.pulse_id;
  out.throttle = in.throttle;
  out.duration = in.duration;
  out.hold_throttle = in.hold_throttle;
  out.hold_duration = in.hold_duration;
  out.pitch = in.pitch;
  out.mixed = in.mixed ? 1 : 0;
  return out;
}

bool fromLcm(const snapwing_lcm::heartbeat_t& in, Heartbeat& out) {
  out.arm_switch = in.arm_switch != 0;
  out.deadman = in.deadman != 0;
  out.reset_fault = in.reset_fault != 0;
  return fromLcm(in.stamp, out.stamp);
}

snapwing_lcm::heartbeat_t toLcm(const Heartbeat& in) {
  snapwing_lcm::heartbeat_t out{};
  out.stamp = toLcm(in.stamp);
  out.arm_switch = in.arm_switch ? 1 : 0;
  out.deadman = in.deadman ? 1 : 0;
  out.reset_fault = in.reset_fault ? 1 : 0;
  return out;
}

bool fromLcm(const snapwing_lcm::abort_t& in, Abort& out) {
  out.reason = in.reason;
  return fromLcm(in.stamp, out.stamp);
}

snapwing_lcm::abort_t toLcm(const Abort& in) {
  snapwing_lcm::abort_t out{};
  out.stamp = toLcm(in.stamp);
  out.reason = in.reason;
  return out;
}

bool fromLcm(const snapwing_lcm::link_status_t& in, BridgeStatus& out) {
  if (in.stamp.version != VERSION || in.channel_count < 0 || in.channel_count > MAX_CHANNELS) return false;
  out.state = static_cast<BridgeState>(in.state);
  out.fault = static_cast<Fault>(in.fault);
  out.fault_detail = in.fault_detail;
  out.pulse_id = in.pulse_id;
  out.commanded_throttle = in.commanded_throttle;
  out.channels.count = in.channel_count;
  for (std::size_t i = 0; i < out.channels.us.size(); ++i)
    out.channels.us[i] = static_cast<std::uint16_t>(in.channels[i]);
  out.number = in.stamp.number;
  out.frame_time = MICRO * static_cast<double>(in.stamp.status_utime);
  out.frames_sent = in.frames_sent;
  out.frames_dropped = in.frames_dropped;
  out.commands_accepted = in.commands_accepted;
  out.commands_refused = in.commands_refused;
  out.last_refusal = static_cast<Refusal>(in.last_refusal);
  out.last_refusal_detail = in.last_refusal_detail;
  out.period_worst = in.period_worst;
  std::copy(std::begin(in.period_histogram), std::end(in.period_histogram), out.period_histogram.begin());
  std::copy(std::begin(in.latency_histogram), std::end(in.latency_histogram), out.latency_histogram.begin());
  out.latency_worst = in.latency_worst;
  out.realtime = in.realtime != 0;
  out.memory_locked = in.memory_locked != 0;
  const double* scale = in.throttle_scale;
  out.throttle = {scale[0], scale[1], scale[2], scale[3], scale[4]};
  out.controller.override_active = in.pilot_override != 0;
  out.controller.connected = in.controller_connected != 0;
  out.controller.known = in.controller_known != 0;
  out.controller.armed = in.controller_armed != 0;
  out.controller.failsafe = in.controller_failsafe != 0;
  out.controller.arming_flags = static_cast<std::uint32_t>(in.arming_disable_flags);
  out.telemetry_age = in.telemetry_age;
  return true;
}

snapwing_lcm::link_status_t toLcm(const BridgeStatus& in, const Stamp& stamp, std::int64_t rejected) {
  snapwing_lcm::link_status_t out{};
  out.stamp = toLcm(stamp);
  out.state = static_cast<std::int8_t>(in.state);
  out.fault = static_cast<std::int32_t>(in.fault);
  out.fault_detail = in.fault_detail;
  out.pulse_id = in.pulse_id;
  out.commanded_throttle = in.commanded_throttle;
  out.channel_count = in.channels.count;
  copyChannels(in.channels, out.channels, MAX_CHANNELS);
  out.frames_sent = in.frames_sent;
  out.frames_dropped = in.frames_dropped;
  out.commands_accepted = in.commands_accepted;
  out.commands_refused = in.commands_refused;
  out.messages_rejected = rejected;
  out.last_refusal = static_cast<std::int32_t>(in.last_refusal);
  out.last_refusal_detail = in.last_refusal_detail;
  out.period_worst = in.period_worst;
  std::copy(in.period_histogram.begin(), in.period_histogram.end(), std::begin(out.period_histogram));
  std::copy(in.latency_histogram.begin(), in.latency_histogram.end(), std::begin(out.latency_histogram));
  out.latency_worst = in.latency_worst;
  out.realtime = in.realtime ? 1 : 0;
  out.memory_locked = in.memory_locked ? 1 : 0;
  const common::ThrottleScale& scale = in.throttle;
  const std::array<double, 5> sent = {scale.low, scale.high, scale.min_check, scale.motor_idle, scale.motor_full};
  std::copy(sent.begin(), sent.end(), std::begin(out.throttle_scale));
  out.pilot_override = in.controller.override_active ? 1 : 0;
  out.controller_connected = in.controller.connected ? 1 : 0;
  out.controller_known = in.controller.known ? 1 : 0;
  out.controller_armed = in.controller.armed ? 1 : 0;
  out.controller_failsafe = in.controller.failsafe ? 1 : 0;
  out.arming_disable_flags = static_cast<std::int32_t>(in.controller.arming_flags);
  out.telemetry_age = in.telemetry_age;
  return out;
}

snapwing_lcm::telemetry_t toLcm(const ControllerTelemetry& in, const Stamp& stamp, double now) {
  snapwing_lcm::telemetry_t out{};
  out.stamp = toLcm(stamp);
  out.api_major = in.api.major;
  out.api_minor = in.api.minor;
  std::memcpy(out.variant, in.variant.data(), sizeof out.variant);
  out.failsafe_delay = in.failsafe_read ? in.failsafe.delay : -1.0;
  out.failsafe_procedure = in.failsafe.procedure;
  out.failsafe_throttle = in.failsafe.throttle;
  out.motor_count = std::min(in.motors.count, 8);
  copyChannels(in.motors, out.motors, 8);
  out.rc_count = in.rc.count;
  copyChannels(in.rc, out.rc, MAX_CHANNELS);
  out.mode_flags = static_cast<std::int64_t>(in.status.modes);
  out.arming_disable_flags = static_cast<std::int32_t>(in.status.arming_flags);
  out.cycle_time = in.status.cycle_time;
  out.status_age = now - in.status_time;
  out.motor_age = now - in.motor_time;
  out.rc_age = now - in.rc_time;
  out.requests = in.requests;
  out.replies = in.replies;
  out.reply_errors = in.reply_errors;
  out.imu_number = in.imu.number;
  std::copy(in.imu.acceleration.begin(), in.imu.acceleration.end(), std::begin(out.imu_acceleration));
  out.imu_age = now - in.imu.time;
  return out;
}

}  // namespace snapwing::link
