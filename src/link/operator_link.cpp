#include "snapwing/link/operator_link.h"

#include <algorithm>
#include <cmath>
#include <lcm/lcm-cpp.hpp>

#include "snapwing/common/error.h"
#include "snapwing/link/clock.h"
#include "snapwing/link/lcm_messages.h"

namespace snapwing::link {

struct OperatorLink::Lcm {
  Lcm(OperatorLink& owner, const std::string& url) : owner_(owner), bus(url) {
    if (!bus.good()) throw common::Error("LCM cannot start with " + url);
    bus.subscribe(CHANNEL_STATUS, &Lcm::onStatus, this);
    bus.subscribe(CHANNEL_TELEMETRY, &Lcm::onTelemetry, this);
  }

  void onStatus(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
    snapwing_lcm::link_status_t wire;
    BridgeStatus status;
    OperatorLink& o = owner_;
    const double now = monotonicSeconds();
    if (!o.sealer_.unwrap(channel, buffer->data, buffer->data_size, wire) || !fromLcm(wire, status)) {
      ++o.counters_.rejected;
      return;
    }
    // A replayed status must not lend its old clock to our stamps: within a session numbers only grow, and another
    // session is believed only once the one we know has gone quiet.
    const bool same = wire.stamp.session == o.session_;
    if (same ? wire.stamp.number <= o.last_status_number_ : now - o.heard_ < BRIDGE_TIMEOUT) {
      ++o.counters_.rejected;
      return;
    }
    if (same) o.counters_.missed += wire.stamp.number - o.last_status_number_ - 1;
    o.session_ = wire.stamp.session;
    o.last_status_number_ = wire.stamp.number;
    o.heard_ = now;
    o.noteClock(now, status.frame_time, !same);
    o.rejected_by_bridge_ = wire.messages_rejected;
    o.status_ = status;
    ++o.counters_.statuses;
    if (o.on_status_) o.on_status_(o.status_);
  }

  void onTelemetry(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
    snapwing_lcm::telemetry_t wire;
    if (!owner_.sealer_.unwrap(channel, buffer->data, buffer->data_size, wire) ||
        wire.stamp.session != owner_.session_) {
      ++owner_.counters_.rejected;
      return;
    }
    owner_.telemetry_ = wire;
    owner_.telemetry_known_ = true;
  }

  OperatorLink& owner_;
  lcm::LCM bus;
};

OperatorLink::OperatorLink(const std::string& url, const Key& key, StatusCallback on_status)
    : lcm_(std::make_unique<Lcm>(*this, url)), sealer_(key), on_status_(std::move(on_status)), sender_id_(randomId()) {}

OperatorLink::~OperatorLink() = default;

void OperatorLink::handle(double timeout) { lcm_->bus.handleTimeout(static_cast<int>(std::ceil(1000.0 * timeout))); }

double OperatorLink::statusAge() const {
  return session_ == 0 ? std::numeric_limits<double>::infinity() : monotonicSeconds() - heard_;
}

bool OperatorLink::bridgeAlive() const { return statusAge() < BRIDGE_TIMEOUT; }

void OperatorLink::noteClock(double now, double bridge_time, bool new_session) {
  const double offset = now - bridge_time;
  if (new_session || now - offset_since_ > 1.0) {
    offset_before_ = new_session ? offset : offset_now_;
    offset_now_ = offset;
    offset_since_ = now;
  }
  offset_now_ = std::min(offset_now_, offset);
}

bool OperatorLink::stamp(Stamp& out, std::int64_t& number) {
  if (!bridgeAlive()) {
    ++counters_.not_sent;
    return false;
  }
  out.sender_id = sender_id_;
  out.session = session_;
  out.number = ++number;
  out.time = monotonicSeconds() - std::min(offset_now_, offset_before_);
  out.expiry = COMMAND_EXPIRY;
  return true;
}

template <class Message>
bool OperatorLink::send(const char* channel, const Message& message) {
  const std::vector<std::uint8_t> bytes = sealer_.wrap(channel, toLcm(message));
  return !bytes.empty() && lcm_->bus.publish(channel, bytes.data(), static_cast<unsigned>(bytes.size())) == 0;
}

bool OperatorLink::sendPulse(std::int64_t pulse_id, double throttle, double duration, double pitch, bool mixed) {
  PulseCommand command;
  command.pulse_id = pulse_id;
  command.throttle = throttle;
  command.duration = duration;
  command.pitch = pitch;
  command.mixed = mixed;
  return stamp(command.stamp, pulse_number_) && send(CHANNEL_PULSE, command);
}

bool OperatorLink::sendHeartbeat(bool arm_switch, bool deadman, bool reset_fault) {
  Heartbeat heartbeat;
  heartbeat.arm_switch = arm_switch;
  heartbeat.deadman = deadman;
  heartbeat.reset_fault = reset_fault;
  return stamp(heartbeat.stamp, heartbeat_number_) && send(CHANNEL_HEARTBEAT, heartbeat);
}

bool OperatorLink::sendAbort(int reason) {
  Abort abort;
  abort.reason = reason;
  return stamp(abort.stamp, abort_number_) && send(CHANNEL_ABORT, abort);
}

}  // namespace snapwing::link
