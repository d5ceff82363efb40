#include "snapwing/link/operator_link.h"

#include <algorithm>
#include <cmath>

#include "lcm_messages.h"
#include "snapwing/link/clock.h"
#include "snapwing_lcm/hello_t.hpp"

namespace snapwing::link {
namespace {

constexpr double HELLO_PERIOD = 0.02;    ///< [s]
constexpr double REPEAT_PERIOD = 0.003;  ///< [s] of what stops thrust: half of the datagrams lost costs 10 ms
constexpr double REPEAT_TIME = 0.06;     ///< [s] at that rate; an abort goes on at the heartbeat's rate
constexpr double CONFLICT_TIME = 1.0;    ///< [s]
constexpr double HINT_TIME = 2.0;        ///< [s]

bool isActive(BridgeState state) { return state == BridgeState::ARMED || state == BridgeState::PULSE; }

}  // namespace

OperatorLink::OperatorLink(const std::string& url, const Sealer& sealer, StatusCallback on_status)
    : socket_(url),
      sealer_(sealer),
      on_status_(std::move(on_status)),
      sender_id_(randomId()),
      began_(monotonicSeconds()) {}

// -- what arrives

void OperatorLink::handle(double timeout) {
  double now = monotonicSeconds();
  maintain(now);
  constexpr int AT_ONCE = 64;  // a flood must not keep us from repeating an abort
  if (socket_.wait(std::clamp(nextDue() - now, 0.0, timeout))) {
    LcmDatagram datagram;
    for (int i = 0; i < AT_ONCE && socket_.receive(datagram); ++i) take(datagram);
  }
  now = monotonicSeconds();
  maintain(now);
}

void OperatorLink::take(const LcmDatagram& datagram) {
  const bool is_status = datagram.channel == CHANNEL_STATUS;
  if (!is_status && datagram.channel != CHANNEL_TELEMETRY) return;
  const double now = monotonicSeconds();
  snapwing_lcm::sealed_t sealed;
  switch (sealer_.open(std::string(datagram.channel), datagram.data, datagram.size, sealed)) {
    case Envelope::OTHER_VERSION: {
      const int version = Sealer::claimedVersion(datagram.data, datagram.size);
      const int ours = snapwing_lcm::sealed_t::VERSION;
      note("a radio bridge of " + std::string(version < ours ? "an older" : "a newer") +
               " release is heard (messages of version " + std::to_string(version) + ", this program speaks version " +
               std::to_string(ours) + "): install the same release at both ends",
           now);
      break;
    }
    case Envelope::OTHER_VEHICLE:
      note("a radio bridge of vehicle '" + vehicleOf(sealed) + "' is heard, this one is '" + vehicleId() + "'", now);
      break;
    case Envelope::BAD:
      note("messages are heard whose seal is wrong: does the bridge use the same key file?", now);
      break;
    case Envelope::GOOD: {
      snapwing_lcm::link_status_t status;
      snapwing_lcm::telemetry_t telemetry;
      if (is_status && status.decode(sealed.payload, 0, sealed.payload_size) == sealed.payload_size) {
        takeStatus(status, now);
        return;
      }
      if (!is_status && telemetry.decode(sealed.payload, 0, sealed.payload_size) == sealed.payload_size) {
        takeTelemetry(telemetry);
        return;
      }
      break;
    }
  }
  ++counters_.rejected;
}

bool OperatorLink::answersUs(const snapwing_lcm::link_status_t& wire, double now) const {
  for (std::size_t i = 0; i < std::size(wire.answer_sender); ++i) {
    if (wire.answer_sender[i] != sender_id_) continue;
    return std::any_of(challenges_.begin(), challenges_.end(), [&](const Challenge& challenge) {
      return challenge.value != 0 && challenge.value == wire.answer_challenge[i] && now - challenge.sent <= PROOF_AGE;
    });
  }
  return false;
}

void OperatorLink::takeStatus(const snapwing_lcm::link_status_t& wire, double now) {
  BridgeStatus status;
  if (!fromLcm(wire, status)) {
    ++counters_.rejected;
    return;
  }
  if (!answersUs(wire, now)) {
    ++counters_.unproven;
    return;
  }
  const bool same = wire.stamp.session == session_;
  // Another session is believed only once the one that we know has gone quiet.
  if (!same && bridgeAlive()) other_heard_ = now;
  if (same ? status.number <= status_.number : bridgeAlive()) {
    ++counters_.rejected;
    return;
  }
  if (same) counters_.missed += status.number - status_.number - 1;
  if (!same) last_telemetry_number_ = abort_after_ = 0;
  session_ = wire.stamp.session;
  heard_ = now;
  rejected_by_bridge_ = wire.messages_rejected;
  status_ = status;
  ++counters_.statuses;
  if (aborting() && status.state == BridgeState::FAULT && status.number > abort_after_) abort_reason_ = 0;
  if (!isActive(status.state)) repeat_until_ = -1e9;
  if (on_status_) on_status_(status_);
}

void OperatorLink::takeTelemetry(const snapwing_lcm::telemetry_t& wire) {
  const bool good = wire.stamp.version == snapwing_lcm::stamp_t::VERSION && wire.stamp.session == session_ &&
                    wire.stamp.number > last_telemetry_number_;
  if (!good) {
    ++counters_.rejected;
    return;
  }
  last_telemetry_number_ = wire.stamp.number;
  telemetry_ = wire;
  telemetry_known_ = true;
}

void OperatorLink::note(const std::string& sentence, double now) {
  hint_ = sentence;
  hint_time_ = now;
}

std::string OperatorLink::hint() const {
  if (conflict())
    return "two radio bridges answer for vehicle '" + vehicleId() + "': stop one, or give each its own id";
  return monotonicSeconds() - hint_time_ < HINT_TIME ? hint_ : "";
}

double OperatorLink::statusAge() const {
  return session_ == 0 ? std::numeric_limits<double>::infinity() : monotonicSeconds() - heard_;
}

bool OperatorLink::bridgeAlive() const { return statusAge() < BRIDGE_TIMEOUT; }
bool OperatorLink::conflict() const { return monotonicSeconds() - other_heard_ < CONFLICT_TIME; }
double OperatorLink::listened() const { return monotonicSeconds() - began_; }

// -- what leaves

void OperatorLink::maintain(double now) {
  if (now >= next_hello_) sayHello(now);
  if (now < next_repeat_) return;
  if (aborting()) {
    repeatAbort(now);
  } else if (now < repeat_until_) {
    next_repeat_ = now + REPEAT_PERIOD;
    beat(wish_);
  }
}

double OperatorLink::nextDue() const {
  const bool repeats = aborting() || repeat_until_ > next_repeat_;
  return repeats ? std::min(next_hello_, next_repeat_) : next_hello_;
}

void OperatorLink::sayHello(double now) {
  next_hello_ = now + HELLO_PERIOD;
  snapwing_lcm::hello_t hello{};
  hello.version = snapwing_lcm::stamp_t::VERSION;
  hello.sender_id = sender_id_;
  hello.challenge = ++challenge_;
  challenges_[next_challenge_++ % challenges_.size()] = {hello.challenge, now};
  const std::vector<std::uint8_t> bytes = sealer_.wrap(CHANNEL_HELLO, hello);
  socket_.publish(CHANNEL_HELLO, bytes.data(), bytes.size());
}

void OperatorLink::repeatAbort(double now) {
  if (now - abort_since_ > ABORT_TIME) {
    abort_reason_ = 0;
    return;
  }
  next_repeat_ = now + (now - abort_since_ < REPEAT_TIME ? REPEAT_PERIOD : HELLO_PERIOD);
  Abort message;
  message.reason = abort_reason_;
  stamp(message.stamp, abort_number_);
  send(CHANNEL_ABORT, message);
  beat({});
}

/// @return whether the bridge is heard; the stamp is made in any case
bool OperatorLink::stamp(Stamp& out, std::int64_t& number) {
  out.sender_id = sender_id_;
  out.session = session_;
  out.number = ++number;
  out.time = status_.frame_time;
  out.status_number = status_.number;
  out.held = monotonicSeconds() - heard_;
  out.expiry = COMMAND_EXPIRY;
  return bridgeAlive();
}

template <class Message>
bool OperatorLink::send(const char* channel, const Message& message) {
  const std::vector<std::uint8_t> bytes = sealer_.wrap(channel, toLcm(message));
  return !bytes.empty() && socket_.publish(channel, bytes.data(), bytes.size());
}

bool OperatorLink::sendPulse(std::int64_t pulse_id, const PulseShape& shape) {
  PulseCommand command{shape, {}, pulse_id};
  if (!stamp(command.stamp, pulse_number_) || aborting()) {
    ++counters_.not_sent;
    return false;
  }
  return send(CHANNEL_PULSE, command);
}

bool OperatorLink::beat(const Wish& wish) {
  Heartbeat heartbeat;
  heartbeat.arm_switch = wish.arm;
  heartbeat.deadman = wish.deadman;
  heartbeat.reset_fault = wish.reset;
  const bool stopping = session_ != 0 && monotonicSeconds() < repeat_until_;  // told also to a bridge that is not heard
  if (!stamp(heartbeat.stamp, heartbeat_number_) && !stopping) {
    ++counters_.not_sent;
    return false;
  }
  return send(CHANNEL_HEARTBEAT, heartbeat);
}

bool OperatorLink::sendHeartbeat(bool arm_switch, bool deadman, bool reset_fault) {
  const bool held_back = aborting() || (conflict() && !isActive(status_.state));
  const Wish wish = held_back ? Wish{} : Wish{arm_switch, deadman, reset_fault};
  if (wish_.active() && !wish.active()) {
    const double now = monotonicSeconds();
    repeat_until_ = now + REPEAT_TIME;
    next_repeat_ = now + REPEAT_PERIOD;
  }
  if (wish.active()) repeat_until_ = -1e9;
  wish_ = wish;
  return beat(wish);
}

bool OperatorLink::abort(int reason) {
  wish_ = {};
  if (session_ == 0) {
    ++counters_.not_sent;
    return false;
  }
  abort_reason_ = std::max(1, reason);
  abort_since_ = monotonicSeconds();
  abort_after_ = status_.number;
  repeatAbort(abort_since_);
  return true;
}

}  // namespace snapwing::link
