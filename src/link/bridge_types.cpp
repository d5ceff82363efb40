#include "snapwing/link/bridge_types.h"

#include <array>
#include <cmath>

#include "controller_checks.h"
#include "snapwing/common/error.h"

namespace snapwing::link {
namespace {

constexpr int IDLE_MARGIN = 50;  ///< [us] above the motors' idle that still is idle

constexpr std::array<const char*, 26> ARMING_FLAGS = {
    "NOGYRO",      "FAILSAFE",    "RXLOSS",     "NOT_DISARMED", "BOXFAILSAFE", "RUNAWAY",   "CRASH",
    "THROTTLE",    "ANGLE",       "BOOTGRACE",  "NOPREARM",     "LOAD",        "CALIB",     "CLI",
    "CMS",         "BST",         "MSP",        "PARALYZE",     "GPS",         "RESCUE_SW", "DSHOT_TELEM",
    "REBOOT_REQD", "DSHOT_BBANG", "NO_ACC_CAL", "MOTOR_PROTO",  "ARMSWITCH"};

std::string milliseconds(std::int64_t microseconds) { return std::to_string(microseconds / 1000) + " ms"; }

void check(const char* key, double value, double low, double high, const char* unit) {
  if (value >= low && value <= high) return;
  throw common::SettingError("radio bridge", key, std::to_string(value),
                             "within [" + std::to_string(low) + ", " + std::to_string(high) + "] " + unit);
}

}  // namespace

const char* stateName(BridgeState state) {
  switch (state) {
    case BridgeState::IDLE:
      return "idle";
    case BridgeState::ARMED:
      return "armed";
    case BridgeState::PULSE:
      return "pulse";
    case BridgeState::FAULT:
      return "fault";
    default:
      return "unknown";
  }
}

std::string describeArmingFlags(std::uint32_t flags) {
  std::string text;
  for (std::size_t bit = 0; bit < 32; ++bit) {
    if ((flags >> bit & 1U) == 0) continue;
    if (!text.empty()) text += ' ';
    text += bit < ARMING_FLAGS.size() ? ARMING_FLAGS[bit] : "BIT" + std::to_string(bit);
  }
  return text.empty() ? "none" : text;
}

std::string describe(Fault fault, std::int64_t detail) {
  const std::string flags = describeArmingFlags(static_cast<std::uint32_t>(detail));
  switch (fault) {
    case Fault::NONE:
      return "";
    case Fault::ABORTED:
      if (detail == 4) return "aborted: the operator's node was late with its callbacks";
      return "aborted (reason " + std::to_string(detail) + ")";
    case Fault::HEARTBEAT_LOST:
      return "operator's heartbeat lost for " + milliseconds(detail);
    case Fault::LINE_LOST:
      return "line to the flight controller lost or blocked";
    case Fault::CONTROLLER_FAILSAFE:
      return "flight controller is in failsafe";
    case Fault::CONTROLLER_DISARMED:
      return "flight controller disarmed by itself (flags: " + flags + ")";
    case Fault::CONTROLLER_NOT_ARMING:
      return "flight controller did not arm (flags: " + flags + ")";
    case Fault::TELEMETRY_LOST:
      return "no status from the flight controller for " + milliseconds(detail);
    case Fault::LOOP_STALLED:
      return "the bridge itself stood still for " + milliseconds(detail);
    case Fault::SHUTDOWN:
      return "the bridge is ending";
    case Fault::MOTORS_DISAGREE:
      return "motors at " + std::to_string(detail) + " us while throttle low is sent";
    case Fault::PILOT_TOOK_OVER:
      return "the pilot let go of the override switch";
    case Fault::OPERATOR_LATE:
      return "operator is late: its heartbeats arrive " + milliseconds(detail) + " old";
    case Fault::GUARDIAN_LOST:
      return "the guardian process is gone: restart radio_bridge";
    case Fault::CLOCKS_DISAGREE:
      return "clocks jumped by " + milliseconds(detail) + " (suspended, paused, or the time was set)";
    case Fault::CONTROLLER_RXLOSS:
      return "flight controller missed frames (flags: " + flags + ")";
  }
  return "fault " + std::to_string(static_cast<int>(fault));
}

std::string describe(Refusal refusal, std::int64_t detail) {
  switch (refusal) {
    case Refusal::NONE:
      return "";
    case Refusal::WRONG_SESSION:
      return "command of another session of the bridge";
    case Refusal::STALE:
      return "command is " + milliseconds(detail) + " old";
    case Refusal::FROM_FUTURE:
      return "command is stamped " + milliseconds(-detail) + " in the future";
    case Refusal::REPEATED_NUMBER:
      return "message number " + std::to_string(detail) + " was used before";
    case Refusal::REPEATED_PULSE:
      return "pulse id " + std::to_string(detail) + " is not above the last one";
    case Refusal::BAD_VALUE:
      return "throttle, duration, hold, pitch or pulse id is not finite or beyond the bridge's limits";
    case Refusal::NOT_ARMED:
      return "not armed, or the flight controller does not report armed yet";
    case Refusal::BUSY:
      return "a pulse is in force or the pause after it is not over";
    case Refusal::OTHER_OPERATOR:
      return "another sender holds the deadman";
    case Refusal::TOO_MANY_SENDERS:
      return "too many senders at once";
    case Refusal::MIXED_NOT_ALLOWED:
      return "mixed control is not allowed (max_pitch is 0)";
    case Refusal::LATCHED_FAULT:
      return "fault latched: " + describe(static_cast<Fault>(detail), 0);
    case Refusal::NOT_CONNECTED:
      return detail > 0 ? "the flight controller is slow: an answer took " + milliseconds(detail)
                        : "no connection to the flight controller";
    case Refusal::CONTROLLER_UNKNOWN:
      return "flight controller not fit to be armed: " + describe(static_cast<Check>(detail));
    case Refusal::CONTROLLER_NOT_READY:
      return "flight controller not ready to arm: " + describeArmingFlags(static_cast<std::uint32_t>(detail));
    case Refusal::CONTROLLER_FAILSAFE:
      return "flight controller is in failsafe";
    case Refusal::SWITCH_NOT_CYCLED:
      return "arm switch must be off once before it counts";
    case Refusal::PILOT_NOT_READY:
      return "the pilot has not armed or does not hold the override switch";
    case Refusal::UNKNOWN_STATUS:
      return "command answers status " + std::to_string(detail) + ", which this bridge has not sent";
    case Refusal::RESET_WHILE_ARMED:
      return "no reset while the flight controller is armed (with override: let go of the override switch first)";
    case Refusal::NO_GUARDIAN:
      return "the guardian process is gone or does not hold the line yet";
  }
  return "refusal " + std::to_string(static_cast<int>(refusal));
}

std::string scaleMismatch(const common::ThrottleScale& bridge, const common::ThrottleScale& vehicle) {
  const std::array<double, 5> ours = {bridge.low, bridge.high, bridge.min_check, bridge.motor_idle, bridge.motor_full};
  const std::array<double, 5> theirs = {vehicle.low, vehicle.high, vehicle.min_check, vehicle.motor_idle,
                                        vehicle.motor_full};
  constexpr std::array<const char*, 5> NAMES = {"throttle_low", "throttle_high", "min_check", "motor_idle",
                                                "motor_full"};
  std::string text;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    if (std::abs(ours[i] - theirs[i]) <= 0.5) continue;
    text += (text.empty() ? "" : ", ") + std::string("radio.") + NAMES[i] + " is " +
            std::to_string(std::lround(ours[i])) + " us at the radio bridge and " +
            std::to_string(std::lround(theirs[i])) + " us in the vehicle file";
  }
  return text.empty() ? text : text + "; start radio_bridge with --vehicle-file of this vehicle";
}

void BridgeSettings::useScale(const common::ThrottleScale& scale) {
  throttle = scale;
  motor_idle_limit = static_cast<int>(std::lround(scale.motor_idle)) + IDLE_MARGIN;
}

const char* describe(Disarming disarming) {
  switch (disarming) {
    case Disarming::SWITCH_OFF:
      return "arm switch off";
    case Disarming::DEADMAN_RELEASED:
      return "deadman released";
    default:
      return "";
  }
}

void BridgeSettings::validate() const {
  imu.validate();
  check("frame_period", frame_period, 0.007, 0.05, "s");
  check("max_age", max_age, frame_period, 0.1, "s");
  check("future_tolerance", future_tolerance, 0.0, 0.02, "s");
  check("heartbeat_timeout", heartbeat_timeout, 0.04, 0.25, "s");
  check("max_throttle", max_throttle, 0.0, 1.0, "");
  check("max_pulse", max_pulse, 0.0, 3.0, "s");
  check("min_rest", min_rest, 0.0, 10.0, "s");
  check("throttle_rise", throttle_rise, 0.0, 1.0, "s");
  check("max_pitch", max_pitch, 0.0, 1.0, "");
  check("arm_timeout", arm_timeout, 0.1, 5.0, "s");
  check("telemetry_timeout", telemetry_timeout, 0.2, 2.0, "s");
  check("stall_limit", stall_limit, 2 * frame_period, 0.2, "s");
  check("line_timeout", line_timeout, 2 * frame_period, 0.2, "s");
  check("motor_check_delay", motor_check_delay, 0.2, 5.0, "s");
  check("motor_idle_limit", motor_idle_limit, 1000, 1200, "us");
  check("throttle.min_check", throttle.min_check, CHANNEL_LOW + 1, CHANNEL_CENTRE, "us");
  check("throttle.low", throttle.low, CHANNEL_MIN_VALID, throttle.min_check - 1, "us");
  check("throttle.high", throttle.high, throttle.min_check + 1, CHANNEL_MAX_VALID, "us");
  check("exit_time", exit_time, 0.2, 2.0, "s");
}

}  // namespace snapwing::link
