#include "bridge_core.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "controller_checks.h"

namespace snapwing::link {
namespace {

constexpr double MIN_GAP = 0.007;  ///< [s] between two frames; SBUS receivers know no faster stream
/// [s] before a pulse's end, or its hold's begin, in which no other frame of it leaves: the controller serves a command
/// in 10.4 ms, and the frame that changes the throttle must not wait behind another.
constexpr double QUIET_BEFORE_CHANGE = 0.0115;
constexpr double TIME_SLACK = 1e-6;   ///< [s] rounding of the timer
constexpr double SLOW_ANSWER = 0.1;   ///< [s] of a controller that is not silent, but late
constexpr double BLIND_ARMING = 0.2;  ///< [s] after which a controller that cannot be read counts as armed

std::int64_t micros(double seconds) { return std::llround(seconds * 1e6); }
bool within(double value, double low, double high) { return value >= low && value <= high; }

/// [s] When the sender says that it sent, within what can be true; for statistics and for the heartbeat's silence.
double sentTime(const Stamp& stamp, double now) { return std::clamp(stamp.time + stamp.held, stamp.time, now); }

void count(Histogram& histogram, double value) {
  std::size_t bin = 0;
  while (bin < HISTOGRAM_EDGES.size() && value >= HISTOGRAM_EDGES[bin]) ++bin;
  ++histogram[bin];
}

}  // namespace

BridgeCore::BridgeCore(const BridgeSettings& settings, std::int64_t session, double now)
    : settings_(settings),
      session_(session),
      next_frame_(now),
      last_tick_(std::numeric_limits<double>::quiet_NaN()),
      wanted_period_(settings.frame_period),
      worst_since_(now),
      low_since_(now) {
  settings_.validate();
  status_.channels = safeChannels();
  status_.throttle = settings_.throttle;
}

Refusal BridgeCore::refuse(Refusal refusal, std::int64_t detail) {
  ++status_.commands_refused;
  status_.last_refusal = refusal;
  status_.last_refusal_detail = detail;
  return refusal;
}

bool BridgeCore::knows(std::int64_t sender_id) const {
  return std::any_of(senders_.begin(), senders_.end(),
                     [sender_id](const Sender& sender) { return sender.used && sender.id == sender_id; });
}

BridgeCore::Sender* BridgeCore::findSender(std::int64_t id, double now) {
  Sender* free_place = nullptr;
  for (Sender& sender : senders_) {
    if (sender.used && sender.id == id) return &sender;
    // A sender unseen for longer than any message lives can be forgotten: what it sent before is stale by now, and what
    // stops at any age is known by the status that it names.
    const bool forgettable = !sender.used || (now - sender.last_seen > 1.0 && !(active() && sender.id == operator_id_));
    if (forgettable && (free_place == nullptr || sender.last_seen < free_place->last_seen)) free_place = &sender;
  }
  if (free_place != nullptr) {
    if (free_place->used) forgotten_status_ = std::max(forgotten_status_, free_place->newest_status);
    *free_place = Sender{};
    free_place->id = id;
    free_place->used = true;
  }
  return free_place;
}

Refusal BridgeCore::checkStamp(const Stamp& stamp, Kind kind, bool stops, double now, std::int64_t& detail) {
  if (stamp.session != session_) return Refusal::WRONG_SESSION;
  // Stopping is always allowed in the session it was meant for, also by an operator who has heard no status for long.
  const Refusal echo = stops ? Refusal::NONE : checkEcho(stamp, now, detail);
  if (echo != Refusal::NONE) return echo;
  if (!knows(stamp.sender_id) && stamp.status_number <= forgotten_status_) {
    detail = micros(std::clamp(now - stamp.time, -1e9, 1e9));
    return Refusal::STALE;
  }
  Sender* sender = findSender(stamp.sender_id, now);
  if (sender == nullptr) return Refusal::TOO_MANY_SENDERS;
  std::int64_t& last = sender->last_number[static_cast<std::size_t>(kind)];
  detail = stamp.number;
  if (stamp.number <= last) return Refusal::REPEATED_NUMBER;
  last = stamp.number;
  sender->newest_status = std::max(sender->newest_status, stamp.status_number);
  sender->last_seen = now;
  detail = 0;
  return Refusal::NONE;
}

Refusal BridgeCore::checkEcho(const Stamp& stamp, double now, std::int64_t& detail) const {
  constexpr double ROUNDING = 1.5e-6;  ///< [s] times travel as whole microseconds
  detail = stamp.status_number;
  const auto kept = static_cast<std::int64_t>(status_times_.size());
  if (stamp.status_number < 1 || stamp.status_number > status_.number) return Refusal::UNKNOWN_STATUS;
  const double age = now - stamp.time;
  const bool remembered = status_.number - stamp.status_number < kept;
  const double left = status_times_[static_cast<std::size_t>(stamp.status_number % kept)];
  if (remembered && !(std::abs(left - stamp.time) <= ROUNDING)) return Refusal::UNKNOWN_STATUS;
  detail = micros(std::clamp(age, -1e9, 1e9));
  if (age < -settings_.future_tolerance) return Refusal::FROM_FUTURE;
  if (!remembered || !(age <= std::min(settings_.max_age, stamp.expiry))) return Refusal::STALE;
  return Refusal::NONE;
}

Refusal BridgeCore::checkPulse(const PulseCommand& command, double now, std::int64_t& detail) const {
  detail = 0;
  const bool holds = command.hold_duration != 0.0 || command.hold_throttle != 0.0;
  const bool hold_sound = !holds || (command.hold_duration > 0.0 && command.hold_throttle > 0.0 &&
                                     command.hold_throttle <= settings_.max_throttle);
  const bool sound = within(command.throttle, 0.0, settings_.max_throttle) && command.duration > 0.0 && hold_sound &&
                     command.whole() <= settings_.max_pulse && command.pulse_id <= MAX_PULSE_ID &&
                     (!command.mixed || within(std::abs(command.pitch), 0.0, std::max(settings_.max_pitch, 1e-12)));
  if (command.mixed && settings_.max_pitch <= 0.0) return Refusal::MIXED_NOT_ALLOWED;
  if (!sound) return Refusal::BAD_VALUE;
  detail = command.pulse_id;
  if (command.pulse_id <= status_.pulse_id) return Refusal::REPEATED_PULSE;
  detail = static_cast<std::int64_t>(status_.fault);
  if (status_.state == BridgeState::FAULT) return Refusal::LATCHED_FAULT;
  detail = 0;
  if (status_.state == BridgeState::PULSE) return Refusal::BUSY;
  if (status_.state != BridgeState::ARMED) return Refusal::NOT_ARMED;
  if (command.stamp.sender_id != operator_id_) return Refusal::OTHER_OPERATOR;
  const bool confirmed = status_.controller.readback ? controller_was_armed_ : now - armed_since_ >= BLIND_ARMING;
  if (!confirmed) return Refusal::NOT_ARMED;
  if (pulse_end_ > 0 && now - pulse_end_ < settings_.min_rest) return Refusal::BUSY;
  return Refusal::NONE;
}

Refusal BridgeCore::onPulse(const PulseCommand& command, double now) {
  std::int64_t detail = 0;
  Refusal refusal = checkStamp(command.stamp, Kind::PULSE, false, now, detail);
  if (refusal == Refusal::NONE) refusal = checkPulse(command, now, detail);
  if (refusal != Refusal::NONE) return refuse(refusal, detail);
  // The latest command before the next frame wins; there is no queue.
  pending_ = command;
  has_pending_ = true;
  urgent_ = true;
  status_.pulse_id = command.pulse_id;
  ++status_.commands_accepted;
  return Refusal::NONE;
}

Refusal BridgeCore::onAbort(const Abort& abort, double now) {
  std::int64_t detail = 0;
  const Refusal refusal = checkStamp(abort.stamp, Kind::ABORT, true, now, detail);
  if (refusal != Refusal::NONE) return refuse(refusal, detail);
  ++status_.commands_accepted;
  latch(Fault::ABORTED, abort.reason);
  return Refusal::NONE;
}

Refusal BridgeCore::onHeartbeat(const Heartbeat& heartbeat, double now) {
  std::int64_t detail = 0;
  const bool wish = heartbeat.arm_switch && heartbeat.deadman;
  const bool stops = !wish && active() && heartbeat.stamp.sender_id == operator_id_;
  const Refusal refusal = checkStamp(heartbeat.stamp, Kind::HEARTBEAT, stops, now, detail);
  if (refusal == Refusal::STALE && heartbeat.stamp.sender_id == operator_id_) {
    late_heartbeat_ = now;
    late_by_ = detail;
  }
  if (refusal != Refusal::NONE) return refuse(refusal, detail);
  Sender& sender = *findSender(heartbeat.stamp.sender_id, now);
  if (!heartbeat.arm_switch) sender.switch_off_seen = true;
  const bool asks = heartbeat.reset_fault && !sender.reset_wished && !heartbeat.arm_switch;
  sender.reset_wished = heartbeat.reset_fault;
  if (asks) {
    const Refusal answer = resetFault(sender, now);
    if (answer != Refusal::NONE) {
      sender.wished = false;
      return refuse(answer, 0);
    }
  }

  const bool begins = wish && !sender.wished;
  sender.wished = wish;
  if (active() && sender.id == operator_id_) {
    last_heartbeat_ = std::max(last_heartbeat_, sentTime(heartbeat.stamp, now));
    if (!wish) disarm(heartbeat.arm_switch ? Disarming::DEADMAN_RELEASED : Disarming::SWITCH_OFF);
    return Refusal::NONE;
  }
  return begins ? wishToArm(heartbeat, sender, now) : Refusal::NONE;
}

Refusal BridgeCore::wishToArm(const Heartbeat& heartbeat, Sender& sender, double now) {
  std::int64_t detail = 0;
  const Refusal refusal = checkArming(sender, now, detail);
  sender.switch_off_seen = false;  // each attempt, also a refused one, needs the switch to be off first
  if (refusal != Refusal::NONE) return refuse(refusal, detail);
  status_.state = BridgeState::ARMED;
  operator_id_ = sender.id;
  last_heartbeat_ = sentTime(heartbeat.stamp, now);
  armed_since_ = now;
  controller_was_armed_ = false;
  has_pending_ = false;
  ++status_.commands_accepted;
  return Refusal::NONE;
}

Refusal BridgeCore::checkArming(const Sender& sender, double now, std::int64_t& detail) const {
  const ControllerState& controller = status_.controller;
  if (active()) return Refusal::OTHER_OPERATOR;
  detail = static_cast<std::int64_t>(status_.fault);
  if (status_.state == BridgeState::FAULT) return Refusal::LATCHED_FAULT;
  detail = 0;
  if (!sender.switch_off_seen) return Refusal::SWITCH_NOT_CYCLED;
  if (!guarded_) return Refusal::NO_GUARDIAN;
  if (controller.slowest_answer > SLOW_ANSWER) detail = micros(controller.slowest_answer);
  if (!controller.connected || now - last_written_ > settings_.line_timeout) return Refusal::NOT_CONNECTED;
  detail = controller.failed_check;
  if (!controller.known) return Refusal::CONTROLLER_UNKNOWN;
  if (!controller.readback) return Refusal::NONE;
  detail = static_cast<std::int64_t>(Check::NOT_READ);
  if (now - controller.status_time > settings_.telemetry_timeout) return Refusal::CONTROLLER_UNKNOWN;
  detail = controller.arming_flags;
  if (controller.failsafe) return Refusal::CONTROLLER_FAILSAFE;
  if (settings_.pilot_override) {
    return controller.armed && controller.override_active ? Refusal::NONE : Refusal::PILOT_NOT_READY;
  }
  if (controller.arming_flags != 0 || controller.armed) return Refusal::CONTROLLER_NOT_READY;
  return Refusal::NONE;
}

Refusal BridgeCore::resetFault(Sender& sender, double now) {
  if (status_.state != BridgeState::FAULT || status_.fault == Fault::SHUTDOWN) return Refusal::NONE;
  const ControllerState& controller = status_.controller;
  const bool fresh = now - controller.status_time <= settings_.telemetry_timeout;
  const bool out_of_reach = settings_.pilot_override && fresh && !controller.override_active;
  if (controller.readback && controller.armed && !out_of_reach) return Refusal::RESET_WHILE_ARMED;
  if (status_.fault == Fault::GUARDIAN_LOST && !guarded_) return Refusal::NO_GUARDIAN;
  status_.state = BridgeState::IDLE;
  status_.fault = Fault::NONE;
  status_.fault_detail = 0;
  sender.switch_off_seen = true;
  ++status_.commands_accepted;
  return Refusal::NONE;
}

void BridgeCore::onClockJump(double jump) {
  if (active()) latch(Fault::CLOCKS_DISAGREE, micros(jump));
}

void BridgeCore::disarm(Disarming why) {
  status_.last_disarming = why;
  urgent_ = true;
  status_.state = BridgeState::IDLE;
  pulse_end_ = std::min(pulse_end_, status_.frame_time);
  has_pending_ = false;
  for (Sender& sender : senders_) sender.switch_off_seen = false;
}

void BridgeCore::latch(Fault fault, std::int64_t detail) {
  if (active()) urgent_ = true;
  has_pending_ = false;
  pulse_end_ = std::min(pulse_end_, status_.frame_time);
  for (Sender& sender : senders_) sender.switch_off_seen = false;
  // The first cause stays, except that ending the bridge cannot be reset and so must show.
  if (status_.state == BridgeState::FAULT && fault != Fault::SHUTDOWN) return;
  status_.state = BridgeState::FAULT;
  status_.fault = fault;
  status_.fault_detail = detail;
}

void BridgeCore::requestShutdown(double now) {
  if (shutdown_since_ >= 0) return;
  shutdown_since_ = now;
  latch(Fault::SHUTDOWN, 0);
}

bool BridgeCore::shutdownDone(double now) const {
  return shutdown_since_ >= 0 && now - shutdown_since_ >= settings_.exit_time;
}

const Channels& BridgeCore::tick(double now) {
  notePeriod(now);
  if (active()) watch(now);
  if (active()) advancePulse(now);
  composeChannels(now);
  status_.frame_time = now;
  status_times_[static_cast<std::size_t>(++status_.number) % status_times_.size()] = now;
  status_.telemetry_age = std::isfinite(status_.controller.status_time) ? now - status_.controller.status_time : -1.0;
  last_tick_ = now;
  schedule(now);
  urgent_ = false;
  return status_.channels;
}

void BridgeCore::notePeriod(double now) {
  if (!std::isfinite(last_tick_)) return;
  const double period = now - last_tick_;
  const bool hurried = (urgent_ || now >= silentFrom()) && now < next_frame_ - TIME_SLACK;  // off the grid on purpose
  if (!hurried) count(status_.period_histogram, std::abs(period - wanted_period_));
  if (now - worst_since_ > 0.5) {
    worst_before_ = worst_now_;
    worst_now_ = 0;
    worst_since_ = now;
  }
  worst_now_ = std::max(worst_now_, period);
  status_.period_worst = std::max(worst_now_, worst_before_);
  if (active() && period > settings_.stall_limit) latch(Fault::LOOP_STALLED, micros(period));
}

void BridgeCore::watch(double now) {
  const double silence = now - last_heartbeat_;
  if (silence > settings_.heartbeat_timeout) {
    const bool late = now - late_heartbeat_ < settings_.heartbeat_timeout;
    return late ? latch(Fault::OPERATOR_LATE, late_by_) : latch(Fault::HEARTBEAT_LOST, micros(silence));
  }
  if (!guarded_) return latch(Fault::GUARDIAN_LOST, 0);
  if (!status_.controller.connected || now - last_written_ > settings_.line_timeout) {
    return latch(Fault::LINE_LOST, 0);
  }
  if (status_.controller.readback) watchController(now);
}

void BridgeCore::watchController(double now) {
  const ControllerState& controller = status_.controller;
  if (controller.failsafe) return latch(Fault::CONTROLLER_FAILSAFE, controller.arming_flags);
  const double age = now - controller.status_time;
  if (controller.status_time > armed_since_ && (controller.arming_flags & RXLOSS_FLAG) != 0) {
    return latch(Fault::CONTROLLER_RXLOSS, controller.arming_flags);
  }
  if (age > settings_.telemetry_timeout) return latch(Fault::TELEMETRY_LOST, micros(age));
  if (settings_.pilot_override && !controller.override_active) return latch(Fault::PILOT_TOOK_OVER, 0);
  if (controller.status_time > armed_since_) {
    if (controller.armed) {
      controller_was_armed_ = true;
    } else if (controller_was_armed_) {
      return latch(Fault::CONTROLLER_DISARMED, controller.arming_flags);
    }
  }
  if (!controller_was_armed_ && now - armed_since_ > settings_.arm_timeout) {
    return latch(Fault::CONTROLLER_NOT_ARMING, controller.arming_flags);
  }
  const bool settled =
      status_.commanded_throttle <= 0.0 && controller.motor_time > low_since_ + settings_.motor_check_delay;
  if (settled && controller.motor_max > settings_.motor_idle_limit) {
    latch(Fault::MOTORS_DISAGREE, controller.motor_max);
  }
}

void BridgeCore::advancePulse(double now) {
  if (status_.state == BridgeState::PULSE && now >= pulse_end_ - TIME_SLACK) status_.state = BridgeState::ARMED;
  if (has_pending_) {
    has_pending_ = false;
    status_.state = BridgeState::PULSE;
    pulse_begun_ = false;
    latest_start_ = pending_.stamp.time + std::min(settings_.max_age, pending_.stamp.expiry);
    endFrom(latest_start_);
  }
  if (status_.state != BridgeState::PULSE || pulse_begun_) return;
  pulse_start_ = now;
  if (now <= latest_start_) return;
  status_.state = BridgeState::ARMED;
  pulse_end_ = now;
  refuse(Refusal::STALE, micros(now - pending_.stamp.time));
}

void BridgeCore::endFrom(double start) {
  hold_start_ = start + pending_.duration;
  pulse_end_ = start + pending_.whole();
}

void BridgeCore::beginPulse(double now) {
  pulse_begun_ = true;
  pulse_start_ = now;
  endFrom(std::min(now, latest_start_));
  noteLatency(now - sentTime(pending_.stamp, now));
  schedule(now);
}

bool BridgeCore::inHold(double now) const { return now >= hold_start_ - TIME_SLACK; }

double BridgeCore::nextChange(double now) const { return inHold(now) ? pulse_end_ : hold_start_; }

bool BridgeCore::changesSoon(double now) const { return inPulse() && nextChange(now) - now < QUIET_BEFORE_CHANGE; }

void BridgeCore::noteLatency(double age) {
  count(status_.latency_histogram, std::max(age, 0.0));
  status_.latency_worst = std::max(status_.latency_worst, age);
}

void BridgeCore::composeChannels(double now) {
  const bool was_low = status_.commanded_throttle <= 0.0;
  status_.channels = safeChannels();
  status_.commanded_throttle = 0.0;
  if (active() && !settings_.pilot_override) status_.channels.us[AUX1] = CHANNEL_HIGH;
  if (status_.state == BridgeState::PULSE) {
    const double rise = settings_.throttle_rise;
    const double ceiling = rise > 0.0 ? (now - pulse_start_ + settings_.frame_period) / rise : 1.0;
    const double wanted = inHold(now) ? pending_.hold_throttle : pending_.throttle;
    status_.commanded_throttle = std::clamp(wanted, 0.0, std::min(settings_.max_throttle, ceiling));
    status_.channels.us[THROTTLE] = travelToMicroseconds(status_.commanded_throttle, settings_.throttle);
    if (pending_.mixed && !inHold(now)) {
      status_.channels.us[PITCH] =
          stickToMicroseconds(std::clamp(pending_.pitch, -settings_.max_pitch, settings_.max_pitch));
    }
  }
  if (!was_low && status_.commanded_throttle <= 0.0) low_since_ = now;
}

void BridgeCore::schedule(double now) {
  const double period = settings_.frame_period;
  double next = std::min(next_frame_, now) + period;  // a hurried frame starts the grid anew
  while (next < now + 0.5 * period) next += period;   // late: skip grid points, never send a burst
  const double quiet = status_.controller.readback ? QUIET_BEFORE_CHANGE : MIN_GAP;
  const double change = nextChange(now);
  if (status_.state == BridgeState::PULSE && next > change - quiet) next = std::max(change, now + MIN_GAP);
  next_frame_ = next;
  wanted_period_ = next - now;
}

double BridgeCore::earliestFrameTime() const {
  return std::isfinite(last_tick_) ? std::min(next_frame_, last_tick_ + MIN_GAP) : next_frame_;
}

double BridgeCore::silentFrom() const {
  const double never = std::numeric_limits<double>::infinity();
  return active() ? last_heartbeat_ + settings_.heartbeat_timeout + TIME_SLACK : never;
}

void BridgeCore::noteGrants(bool realtime, bool memory_locked) {
  status_.realtime = realtime;
  status_.memory_locked = memory_locked;
}

void BridgeCore::onSent(bool written, double now) {
  if (written) {
    ++status_.frames_sent;
    last_written_ = now;
  } else {
    ++status_.frames_dropped;
  }
  if (status_.state != BridgeState::PULSE || pulse_begun_) return;
  if (written) {
    beginPulse(now);
  } else {
    urgent_ = true;  // as soon as the line is free
  }
}

}  // namespace snapwing::link
