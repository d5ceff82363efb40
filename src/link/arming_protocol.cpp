#include "snapwing/link/arming_protocol.h"

namespace snapwing::link {
namespace {

bool isArmed(const BridgeStatus& status) {
  return status.state == BridgeState::ARMED || status.state == BridgeState::PULSE;
}

std::string noBridge(const LinkView& view) {
  return "no radio bridge heard" + (view.hint.empty() ? "" : "; " + view.hint);
}

std::string conflictText(const LinkView& view) {
  return view.hint.empty() ? "two radio bridges are heard for this vehicle" : view.hint;
}

std::string reasonOf(const BridgeStatus& status) { return describe(status.last_refusal, status.last_refusal_detail); }

}  // namespace

std::int64_t ArmingProtocol::ask(Request request, const LinkView& view, double now) {
  const std::int64_t ticket = ++last_ticket_;
  if (state_ == State::ABORT && request != Request::ABORT) {
    keep(ticket, false, "an abort is under way");
    return ticket;
  }
  if (open_) keep(ticket_, false, "superseded by another request");
  ticket_ = ticket;
  open_ = true;
  refused_before_ = view.status.commands_refused;
  number_before_ = view.status.number;
  switch (request) {
    case Request::ARM:
      if (state_ == State::ON && view.alive && isArmed(view.status) && view.status.controller.armed) {
        finish(State::ON, true, "armed", now);
      } else {
        enter(State::CYCLE, now);
      }
      break;
    case Request::DISARM:
      enter(State::DISARM, now);
      break;
    case Request::RESET:
      enter(State::RESET_CYCLE, now);
      break;
    case Request::ABORT:
      enter(State::ABORT, now);
      break;
  }
  return ticket;
}

bool ArmingProtocol::answer(std::int64_t ticket, ArmingAnswer& out) const {
  const Kept& kept = kept_[static_cast<std::size_t>(ticket) % kept_.size()];
  if (kept.ticket != ticket || ticket == 0) return false;
  out = kept.answer;
  return true;
}

void ArmingProtocol::keep(std::int64_t ticket, bool success, const std::string& message) {
  kept_[static_cast<std::size_t>(ticket) % kept_.size()] = {ticket, {success, message}};
}

void ArmingProtocol::enter(State state, double now) {
  state_ = state;
  since_ = now;
}

void ArmingProtocol::finish(State state, bool success, const std::string& message, double now) {
  enter(state, now);
  if (open_) keep(ticket_, success, message);
  open_ = false;
}

bool ArmingProtocol::refusedSince(const LinkView& view) const {
  return view.alive && view.status.number > number_before_ && view.status.commands_refused > refused_before_;
}

void ArmingProtocol::step(const LinkView& view, double now) {
  const bool over = now - since_ > times_.answer_time;
  switch (state_) {
    case State::OFF:
      break;
    case State::CYCLE:
      stepCycle(view, now);
      break;
    case State::ASK:
      stepAsk(view, now);
      break;
    case State::CONFIRM:
      stepConfirm(view, now);
      break;
    case State::ON:
      if (view.alive && !isArmed(view.status)) finish(State::OFF, false, "disarmed", now);
      break;
    case State::DISARM:
      if (view.alive && view.status.number > number_before_ && !isArmed(view.status)) {
        finish(State::OFF, true, "disarmed", now);
      } else if (over) {
        finish(State::OFF, false, "the radio bridge does not confirm; without heartbeat it disarms by itself", now);
      }
      break;
    case State::RESET_CYCLE:
    case State::RESET:
      stepReset(view, now);
      break;
    case State::ABORT:
      stepAbort(view, now);
      break;
  }
}

void ArmingProtocol::stepCycle(const LinkView& view, double now) {
  if (view.conflict) return finish(State::OFF, false, conflictText(view), now);
  const bool settled = view.listened >= times_.listen_time;
  const bool shown = now - since_ >= times_.cycle_time;
  if (view.alive && settled && view.deadman_held && shown) {
    refused_before_ = view.status.commands_refused;
    number_before_ = view.status.number;
    return enter(State::ASK, now);
  }
  if (now - since_ <= times_.cycle_time + times_.answer_time) return;
  finish(State::OFF, false, view.alive ? "the deadman is not held" : noBridge(view), now);
}

void ArmingProtocol::stepAsk(const LinkView& view, double now) {
  if (view.conflict) return finish(State::OFF, false, conflictText(view), now);
  if (view.alive && isArmed(view.status) && view.status.number > number_before_) return enter(State::CONFIRM, now);
  if (refusedSince(view)) return finish(State::OFF, false, reasonOf(view.status), now);
  if (now - since_ <= times_.answer_time) return;
  finish(State::OFF, false, view.alive ? "the radio bridge does not answer" : noBridge(view), now);
}

void ArmingProtocol::stepConfirm(const LinkView& view, double now) {
  if (!view.alive) {
    if (now - since_ > times_.arm_timeout) finish(State::OFF, false, noBridge(view), now);
    return;
  }
  if (isArmed(view.status)) {
    if (view.status.controller.armed) return finish(State::ON, true, "armed", now);
    if (now - since_ > times_.arm_timeout) {
      finish(State::OFF, false, "the flight controller does not report armed", now);
    }
    return;
  }
  const BridgeStatus& status = view.status;
  finish(State::OFF, false,
         status.fault == Fault::NONE ? "the radio bridge has disarmed" : describe(status.fault, status.fault_detail),
         now);
}

void ArmingProtocol::stepReset(const LinkView& view, double now) {
  if (state_ == State::RESET_CYCLE) {
    if (now - since_ < times_.cycle_time) return;
    refused_before_ = view.status.commands_refused;
    number_before_ = view.status.number;
    return enter(State::RESET, now);
  }
  const BridgeStatus& status = view.status;
  if (view.alive && status.number > number_before_ && status.state != BridgeState::FAULT) {
    return finish(State::OFF, true, "no fault", now);
  }
  if (refusedSince(view)) return finish(State::OFF, false, reasonOf(status), now);
  if (now - since_ <= times_.answer_time) return;
  finish(State::OFF, false, view.alive ? describe(status.fault, status.fault_detail) : noBridge(view), now);
}

void ArmingProtocol::stepAbort(const LinkView& view, double now) {
  if (view.alive && view.status.number > number_before_ && view.status.state == BridgeState::FAULT) {
    return finish(State::OFF, true, "aborted; reset_link clears the fault", now);
  }
  if (now - since_ > times_.abort_time) {
    finish(State::OFF, false, "the radio bridge does not confirm; without heartbeat it disarms by itself", now);
  }
}

}  // namespace snapwing::link
