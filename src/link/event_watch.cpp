#include "link_log.h"

namespace snapwing::link {
namespace {

constexpr double SILENCE = 2.0;          ///< [s] of an open line without an answer that is worth a word
constexpr double REFUSAL_SPACING = 1.0;  ///< [s] between equal refusals

bool isActive(BridgeState state) { return state == BridgeState::ARMED || state == BridgeState::PULSE; }

}  // namespace

void EventWatch::tell(LogKind kind, std::int64_t code, std::int64_t detail, double value, double seconds) {
  sink_(owner_, LogEvent{0, kind, code, detail, value, seconds});
}

void EventWatch::look(const BridgeStatus& status, const Line& line, double now, void* owner, Sink sink) {
  owner_ = owner;
  sink_ = sink;
  lookAtLine(line, now);
  lookAtController(status, line, now);
  lookAtState(status);
  lookAtPulse(status);
  if (status.commands_refused > before_.commands_refused &&
      (status.last_refusal != last_refusal_ || now - refusal_told_ >= REFUSAL_SPACING)) {
    tell(LogKind::REFUSED, static_cast<std::int64_t>(status.last_refusal), status.last_refusal_detail,
         static_cast<double>(status.commands_refused));
    last_refusal_ = status.last_refusal;
    refusal_told_ = now;
  }
  before_ = status;
  line_ = line;
}

void EventWatch::lookAtLine(const Line& line, double now) {
  const bool another = line.connections != line_.connections;
  if (line_.open && (!line.open || another)) tell(LogKind::LINE_CLOSED, 0, line.open ? 0 : line.error);
  if (line_.open && !line.open) failure_told_ = true;
  if (line.open && another) {
    tell(LogKind::LINE_OPEN);
    open_since_ = now;
    failure_told_ = known_ = silence_told_ = false;
    check_told_ = 0;
  }
  const bool other_reason = line.error != line_.error;
  if (!line.open && line.error != 0 && (!failure_told_ || (other_reason && !line_.open))) {
    tell(LogKind::LINE_FAILED, 0, line.error);
    failure_told_ = true;
  }
}

void EventWatch::lookAtController(const BridgeStatus& status, const Line& line, double now) {
  const ControllerState& controller = status.controller;
  if (!line.open || !controller.readback) return;
  constexpr int NOT_READ = 1;
  if (!silence_told_ && !known_ && !controller.connected && now - open_since_ > SILENCE) {
    tell(LogKind::CONTROLLER_SILENT);
    silence_told_ = true;
  }
  if (controller.known && !known_) {
    tell(LogKind::CONTROLLER_KNOWN);
    known_ = true;
  }
  if (controller.connected && controller.failed_check > NOT_READ && controller.failed_check != check_told_) {
    tell(LogKind::CONTROLLER_REFUSED, controller.failed_check);
    check_told_ = controller.failed_check;
  }
}

void EventWatch::lookAtState(const BridgeStatus& status) {
  const bool was = isActive(before_.state), is = isActive(status.state);
  if (is && !was) tell(LogKind::ARMED);
  if (was && status.state == BridgeState::IDLE) {
    tell(LogKind::DISARMED, static_cast<std::int64_t>(status.last_disarming));
  }
  if (status.state == BridgeState::FAULT && status.fault != before_.fault) {
    tell(LogKind::FAULT, static_cast<std::int64_t>(status.fault), status.fault_detail);
  }
  if (before_.state == BridgeState::FAULT && status.state == BridgeState::IDLE) tell(LogKind::RESET);
}

void EventWatch::lookAtPulse(const BridgeStatus& status) {
  const bool another = status.pulse_id != pulse_;
  if (in_pulse_ && (status.state != BridgeState::PULSE || another)) {
    tell(LogKind::PULSE_ENDED, pulse_, 0, 0, status.frame_time - pulse_since_);
    in_pulse_ = false;
  }
  if (!in_pulse_ && status.state == BridgeState::PULSE && status.frames_sent > before_.frames_sent) {
    in_pulse_ = true;
    pulse_ = status.pulse_id;
    pulse_since_ = status.frame_time;
    tell(LogKind::PULSE_BEGAN, pulse_, 0, status.commanded_throttle);
  }
}

}  // namespace snapwing::link
