#include "snapwing/link/controller_watch.h"

#include <algorithm>
#include <cstring>

#include "snapwing/common/error.h"

namespace snapwing::link {
namespace {

constexpr std::array<std::uint16_t, 5> IDENTITY = {MSP_API_VERSION, MSP_FC_VARIANT, MSP_RX_MAP, MSP_FAILSAFE_CONFIG,
                                                   MSP_BOXIDS};
constexpr std::array<std::uint16_t, 6> ROTATION = {MSP_STATUS, MSP_MOTOR, MSP_STATUS, MSP_MOTOR, MSP_STATUS, MSP_RC};
constexpr double ANSWER_TIMEOUT = 0.2;  ///< [s] then the question counts as lost and the next one is asked
constexpr int KNOWN_API_MAJOR = 1, KNOWN_API_MINOR = 46;
constexpr double LONGEST_FAILSAFE_DELAY = 1.5 + 1e-9;  ///< [s]
constexpr int PROCEDURE_MOTORS_OFF = 1;

}  // namespace

const char* checkName(Check check) {
  switch (check) {
    case Check::CONTROLLER:
      return "controller";
    case Check::API_VERSION:
      return "api-version";
    case Check::RX_MAP:
      return "rx-map";
    case Check::FAILSAFE_DELAY:
      return "failsafe-delay";
    case Check::FAILSAFE_PROCEDURE:
      return "failsafe-procedure";
    default:
      return "";
  }
}

ControllerWatch::ControllerWatch(MspVersion version, const std::set<std::string>& allowed, bool pilot_override)
    : version_(version), pilot_override_(pilot_override) {
  for (const std::string& name : allowed) {
    bool known = false;
    for (const Check check :
         {Check::CONTROLLER, Check::API_VERSION, Check::RX_MAP, Check::FAILSAFE_DELAY, Check::FAILSAFE_PROCEDURE}) {
      if (name != checkName(check)) continue;
      allowed_mask_ |= 1U << static_cast<int>(check);
      known = true;
    }
    if (!known) {
      throw common::SettingError("radio bridge", "allow", name,
                                 "controller, api-version, rx-map, failsafe-delay, failsafe-procedure");
    }
  }
}

void ControllerWatch::connected(double now) {
  const ControllerTelemetry before = telemetry_;
  telemetry_ = ControllerTelemetry{};
  telemetry_.requests = before.requests;
  telemetry_.replies = before.replies;
  telemetry_.reply_errors = before.reply_errors;
  state_ = ControllerState{};
  state_.connected = true;
  state_.failed_check = static_cast<int>(Check::NOT_READ);
  identity_read_.fill(false);
  asked_ = 0;
  asked_time_ = now;
  last_answer_ = now;
  unanswered_frames_ = 0;
}

void ControllerWatch::disconnected() {
  state_.connected = false;
  state_.known = false;
}

bool ControllerWatch::asking(double now) const { return asked_ != 0 && now - asked_time_ < ANSWER_TIMEOUT; }

bool ControllerWatch::nextRequest(double now, MspPacket& out) {
  if (!state_.connected || frame_++ % 2 != 0) return false;
  if (asking(now)) return false;
  std::uint16_t id = 0;
  for (std::size_t i = 0; i < IDENTITY.size() && id == 0; ++i) {
    if (!identity_read_[i]) id = IDENTITY[i];
  }
  if (id == 0) id = ROTATION[turn_++ % ROTATION.size()];
  out = request(version_, id);
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
  if (packet.id == asked_) asked_ = 0;
  bool good = packet.direction == '>';
  if (good && packet.id == MSP_API_VERSION) good = decode(packet, telemetry_.api);
  if (good && packet.id == MSP_FC_VARIANT) {
    good = packet.size >= 4;
    if (good) std::memcpy(telemetry_.variant.data(), packet.payload.data(), 4);
  }
  if (good && packet.id == MSP_RX_MAP) good = decode(packet, rx_map_);
  if (good && packet.id == MSP_FAILSAFE_CONFIG) good = telemetry_.failsafe_read = decode(packet, telemetry_.failsafe);
  if (good && packet.id == MSP_BOXIDS) good = decode(packet, boxes_);
  if (good && packet.id == MSP_MOTOR && (good = decode(packet, telemetry_.motors))) {
    telemetry_.motor_time = state_.motor_time = now;
    const auto end = telemetry_.motors.us.begin() + std::min(telemetry_.motors.count, 8);
    state_.motor_max = *std::max_element(telemetry_.motors.us.begin(), end);
  }
  if (good && packet.id == MSP_RC && (good = decode(packet, telemetry_.rc))) telemetry_.rc_time = now;
  ++(good ? telemetry_.replies : telemetry_.reply_errors);
  if (!good) return;
  for (std::size_t i = 0; i < IDENTITY.size(); ++i) {
    if (IDENTITY[i] == packet.id) identity_read_[i] = true;
  }
  judge();
  if (packet.id == MSP_STATUS) onStatus(packet, now);
}

void ControllerWatch::judge() {
  Check failed = Check::NONE;
  if (std::find(identity_read_.begin(), identity_read_.end(), false) != identity_read_.end()) {
    failed = Check::NOT_READ;
  } else {
    failed = judgeIdentity();
  }
  state_.failed_check = static_cast<int>(failed);
  state_.known = failed == Check::NONE;
  arm_bit_ = boxes_.find(BOX_ARM);
  failsafe_bit_ = boxes_.find(BOX_FAILSAFE);
  override_bit_ = boxes_.find(BOX_MSP_OVERRIDE);
}

Check ControllerWatch::judgeIdentity() const {
  const auto fails = [this](Check check, bool good) { return !good && !allowed(check); };
  if (fails(Check::CONTROLLER, std::memcmp(telemetry_.variant.data(), "BTFL", 4) == 0)) return Check::CONTROLLER;
  const bool api = telemetry_.api.major == KNOWN_API_MAJOR && telemetry_.api.minor == KNOWN_API_MINOR;
  if (fails(Check::API_VERSION, api)) return Check::API_VERSION;
  if (fails(Check::RX_MAP, rx_map_.map == DEFAULT_RX_MAP)) return Check::RX_MAP;
  if (fails(Check::FAILSAFE_DELAY, telemetry_.failsafe.delay <= LONGEST_FAILSAFE_DELAY)) return Check::FAILSAFE_DELAY;
  if (fails(Check::FAILSAFE_PROCEDURE, telemetry_.failsafe.procedure == PROCEDURE_MOTORS_OFF)) {
    return Check::FAILSAFE_PROCEDURE;
  }
  if (boxes_.find(BOX_ARM) < 0 || boxes_.find(BOX_FAILSAFE) < 0) return Check::BOX_IDS;
  if (pilot_override_ && boxes_.find(BOX_MSP_OVERRIDE) < 0) return Check::OVERRIDE_BOX;
  return Check::NONE;
}

void ControllerWatch::onStatus(const MspPacket& packet, double now) {
  if (!decode(packet, telemetry_.status)) {
    ++telemetry_.reply_errors;
    return;
  }
  const auto on = [this](int bit) { return bit >= 0 && (telemetry_.status.modes >> bit & 1U) != 0; };
  state_.armed = on(arm_bit_);
  state_.failsafe = on(failsafe_bit_);
  state_.override_active = on(override_bit_);
  state_.arming_flags = telemetry_.status.arming_flags;
  state_.status_time = telemetry_.status_time = now;
}

}  // namespace snapwing::link
