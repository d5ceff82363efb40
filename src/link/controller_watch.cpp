#include "controller_watch.h"

#include <algorithm>

namespace snapwing::link {
namespace {

constexpr std::array<std::uint16_t, 6> ROTATION = {MSP_STATUS, MSP_MOTOR, MSP_STATUS, MSP_MOTOR, MSP_STATUS, MSP_RC};
constexpr double ANSWER_TIMEOUT = 0.2;  ///< [s] then the question counts as lost and the next one is asked

}  // namespace

ControllerWatch::ControllerWatch(MspVersion version, const ControllerRules& rules, const ImuSettings& imu)
    : version_(version), rules_(rules), imu_(imu) {}

void ControllerWatch::connected(double now) {
  const ControllerTelemetry before = telemetry_;
  telemetry_ = ControllerTelemetry{};
  telemetry_.requests = before.requests;
  telemetry_.replies = before.replies;
  telemetry_.reply_errors = before.reply_errors;
  telemetry_.imu = before.imu;
  imu_.connected();
  state_ = ControllerState{};
  state_.connected = true;
  state_.failed_check = static_cast<int>(Check::NOT_READ);
  answers_ = ControllerAnswers{};
  slowest_answer_ = 0;
  asked_ = late_ = 0;
  asked_time_ = now;
  last_answer_ = now;
  unanswered_frames_ = 0;
}

void ControllerWatch::disconnected() {
  state_.connected = false;
  state_.known = false;
}

bool ControllerWatch::asking(double now) const { return asked_ != 0 && now - asked_time_ < ANSWER_TIMEOUT; }

bool ControllerWatch::nextRequest(double now, MspPacket& out, bool always) {
  if (!state_.connected || (!imu_.mayAsk(frame_++) && !always)) return false;
  if (asking(now)) return false;
  std::uint16_t id = 0;
  for (std::size_t i = 0; i < QUESTIONS.size() && id == 0; ++i) {
    if (answers_.answers[i] == Answer::MISSING) id = QUESTIONS[i];
  }
  if (id == 0 && imu_.next()) id = MSP_RAW_IMU;
  if (id == 0) id = ROTATION[turn_++ % ROTATION.size()];
  out = request(version_, id);
  if (asked_ != 0) {
    late_ = asked_;
    late_time_ = asked_time_;
  }
  asked_ = id;
  asked_time_ = now;
  ++telemetry_.requests;
  return true;
}

void ControllerWatch::onPacket(const MspPacket& packet, double now) {
  if (packet.direction == '<') return;
  last_answer_ = now;
  if (packet.id == MSP_SET_RAW_RC) {
    unanswered_frames_ = 0;
    return;
  }
  if (packet.id == asked_ || packet.id == late_) {
    const bool late = packet.id == late_;  // answers come in order
    const double since = late ? late_time_ : asked_time_;
    slowest_answer_ = state_.slowest_answer = std::max(slowest_answer_, now - since);
    (late ? late_ : asked_) = 0;
  }
  bool good = packet.direction == '>';
  if (answers_.take(packet)) {
    good = answers_.answer(packet.id) == Answer::GOOD;
    judge();
  } else {
    good = packet.id == MSP_RAW_IMU ? imu_.take(packet, now) : good && takeState(packet, now);
    telemetry_.imu = imu_.reading();
  }
  ++(good ? telemetry_.replies : telemetry_.reply_errors);
}

bool ControllerWatch::takeState(const MspPacket& packet, double now) {
  if (packet.id == MSP_STATUS) return onStatus(packet, now);
  if (packet.id == MSP_RC) {
    if (!decode(packet, telemetry_.rc)) return false;
    telemetry_.rc_time = now;
  }
  if (packet.id == MSP_MOTOR) {
    if (!decode(packet, telemetry_.motors)) return false;
    telemetry_.motor_time = state_.motor_time = now;
    const auto end = telemetry_.motors.us.begin() + std::min(telemetry_.motors.count, 8);
    state_.motor_max = *std::max_element(telemetry_.motors.us.begin(), end);
  }
  return true;
}

void ControllerWatch::judge() {
  const Check failed = firstFailed(answers_, rules_);
  state_.failed_check = static_cast<int>(failed);
  state_.known = failed == Check::NONE;
  telemetry_.api = answers_.api;
  telemetry_.variant = answers_.variant;
  telemetry_.failsafe = answers_.failsafe;
  telemetry_.failsafe_read = answers_.answer(MSP_FAILSAFE_CONFIG) == Answer::GOOD;
  arm_bit_ = answers_.boxes.find(BOX_ARM);
  failsafe_bit_ = answers_.boxes.find(BOX_FAILSAFE);
  override_bit_ = answers_.boxes.find(BOX_MSP_OVERRIDE);
}

bool ControllerWatch::onStatus(const MspPacket& packet, double now) {
  if (!decode(packet, telemetry_.status)) return false;
  const auto on = [this](int bit) { return bit >= 0 && (telemetry_.status.modes >> bit & 1U) != 0; };
  state_.armed = on(arm_bit_);
  state_.failsafe = on(failsafe_bit_);
  state_.override_active = on(override_bit_);
  state_.arming_flags = telemetry_.status.arming_flags;
  state_.status_time = telemetry_.status_time = now;
  return true;
}

}  // namespace snapwing::link
