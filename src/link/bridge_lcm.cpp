#include "snapwing/link/bridge_lcm.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <lcm/lcm-cpp.hpp>

#include "snapwing/common/error.h"
#include "snapwing/link/clock.h"
#include "snapwing/link/lcm_messages.h"

namespace snapwing::link {
namespace {

constexpr std::size_t KEPT_FOR_ABORT = 16;  ///< places of the inbox that only an abort may take
constexpr double STATUS_EXPIRY = 0.2;       ///< [s]
constexpr int TELEMETRY_EVERY = 5;          ///< frames

int makeEvent() {
  const int descriptor = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  if (descriptor < 0) throw common::Error("no eventfd");
  return descriptor;
}

void raiseEvent(int descriptor) {
  const std::uint64_t one = 1;
  const ssize_t ignored = write(descriptor, &one, sizeof one);
  (void)ignored;  // a full counter wakes the reader as well
}

}  // namespace

struct BridgeLcm::Lcm {
  explicit Lcm(BridgeLcm& owner, const std::string& url) : owner_(owner), in(url), out(url) {
    if (!in.good() || !out.good()) throw common::Error("LCM cannot start with " + url);
    in.subscribe(CHANNEL_PULSE, &Lcm::onPulse, this);
    in.subscribe(CHANNEL_ABORT, &Lcm::onAbort, this);
    in.subscribe(CHANNEL_HEARTBEAT, &Lcm::onHeartbeat, this);
  }

  /// Checks the envelope, translates and queues; whatever is not right is counted and forgotten.
  template <class Wire, class Plain>
  void take(const lcm::ReceiveBuffer* buffer, const std::string& channel, Inbound::Kind kind, Plain Inbound::*member) {
    Wire wire;
    Inbound item;
    item.kind = kind;
    const bool good =
        owner_.sealer_.unwrap(channel, buffer->data, buffer->data_size, wire) && fromLcm(wire, item.*member);
    const std::size_t keep_free = kind == Inbound::Kind::ABORT ? 0 : KEPT_FOR_ABORT;
    if (!good || !owner_.inbox_.push(item, keep_free)) {
      owner_.rejected_.fetch_add(1, std::memory_order_relaxed);
      return;
    }
    raiseEvent(owner_.arrival_);
  }
  void onPulse(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
    take<snapwing_lcm::pulse_command_t>(buffer, channel, Inbound::Kind::PULSE, &Inbound::pulse);
  }
  void onHeartbeat(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
    take<snapwing_lcm::heartbeat_t>(buffer, channel, Inbound::Kind::HEARTBEAT, &Inbound::heartbeat);
  }
  void onAbort(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
    take<snapwing_lcm::abort_t>(buffer, channel, Inbound::Kind::ABORT, &Inbound::abort);
  }

  BridgeLcm& owner_;
  lcm::LCM in;   ///< listener's
  lcm::LCM out;  ///< publisher's: its own, so that a flood of messages cannot hold up the status
};

BridgeLcm::BridgeLcm(const std::string& url, const Key& key, std::int64_t session, Inbox& inbox, Outbox& outbox)
    : sealer_(key), session_(session), inbox_(inbox), outbox_(outbox) {
  lcm_ = std::make_unique<Lcm>(*this, url);
  event_ = makeEvent();
  arrival_ = makeEvent();
  listener_ = std::thread([this] { listen(); });
  publisher_ = std::thread([this] { publish(); });
}

BridgeLcm::~BridgeLcm() {
  stop_ = true;
  listener_.join();
  publisher_.join();
  close(event_);
  close(arrival_);
}

void BridgeLcm::notify() { raiseEvent(event_); }

void BridgeLcm::listen() {
  while (!stop_) lcm_->in.handleTimeout(50);
}

void BridgeLcm::publish() {
  Outbound item;
  while (!stop_) {
    pollfd waiting{event_, POLLIN, 0};
    if (poll(&waiting, 1, 50) > 0) {
      std::uint64_t count = 0;
      const ssize_t ignored = read(event_, &count, sizeof count);
      (void)ignored;
    }
    while (outbox_.pop(item)) publishOne(item);
  }
}

void BridgeLcm::publishOne(const Outbound& item) {
  Stamp stamp;
  stamp.sender_id = session_;
  stamp.session = session_;
  stamp.number = ++status_number_;
  stamp.time = item.status.frame_time;
  stamp.expiry = STATUS_EXPIRY;
  const auto send = [this](const char* channel, const auto& message) {
    const std::vector<std::uint8_t> bytes = sealer_.wrap(channel, message);
    if (!bytes.empty()) lcm_->out.publish(channel, bytes.data(), static_cast<unsigned>(bytes.size()));
  };
  send(CHANNEL_STATUS, toLcm(item.status, stamp, rejected_.load(std::memory_order_relaxed)));
  if (status_number_ % TELEMETRY_EVERY != 0) return;
  stamp.number = ++telemetry_number_;
  send(CHANNEL_TELEMETRY, toLcm(item.telemetry, stamp, item.status.frame_time));
}

}  // namespace snapwing::link
