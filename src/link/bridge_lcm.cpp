#include "bridge_lcm.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>

#include "lcm_messages.h"
#include "snapwing/common/error.h"
#include "snapwing/link/clock.h"
#include "snapwing_lcm/hello_t.hpp"

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

BridgeLcm::BridgeLcm(const std::string& url, const Sealer& sealer, std::int64_t session, Inbox& inbox, Outbox& outbox)
    : sealer_(sealer), in_(url), out_(url), session_(session), inbox_(inbox), outbox_(outbox) {
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
  while (!stop_) {
    LcmDatagram datagram;
    if (!in_.wait(0.05)) continue;
    while (!stop_ && in_.receive(datagram)) take(datagram);
  }
}

/// Checks the envelope, translates and queues; whatever is not right is counted and forgotten.
void BridgeLcm::take(const LcmDatagram& datagram) {
  bool good = true;
  if (datagram.channel == CHANNEL_ABORT) {
    good = queue<snapwing_lcm::abort_t>(datagram, Inbound::Kind::ABORT, &Inbound::abort);
  } else if (datagram.channel == CHANNEL_HEARTBEAT) {
    good = queue<snapwing_lcm::heartbeat_t>(datagram, Inbound::Kind::HEARTBEAT, &Inbound::heartbeat);
  } else if (datagram.channel == CHANNEL_PULSE) {
    good = queue<snapwing_lcm::pulse_command_t>(datagram, Inbound::Kind::PULSE, &Inbound::pulse);
  } else if (datagram.channel == CHANNEL_HELLO) {
    good = greet(datagram);
  }
  if (!good) rejected_.fetch_add(1, std::memory_order_relaxed);
}

template <class Wire, class Plain>
bool BridgeLcm::queue(const LcmDatagram& datagram, Inbound::Kind kind, Plain Inbound::*member) {
  Wire wire;
  Inbound item;
  item.kind = kind;
  const bool good =
      sealer_.unwrap(std::string(datagram.channel), datagram.data, datagram.size, wire) && fromLcm(wire, item.*member);
  const std::size_t keep_free = kind == Inbound::Kind::ABORT ? 0 : KEPT_FOR_ABORT;
  if (!good || !inbox_->push(item, keep_free)) return false;
  raiseEvent(arrival_);
  return true;
}

bool BridgeLcm::greet(const LcmDatagram& datagram) {
  snapwing_lcm::hello_t hello;
  const bool good = sealer_.unwrap(CHANNEL_HELLO, datagram.data, datagram.size, hello) &&
                    hello.version == snapwing_lcm::stamp_t::VERSION;
  if (!good) return false;
  const std::lock_guard<std::mutex> lock(greetings_mutex_);
  return greetings_.take(hello.sender_id, hello.challenge, monotonicSeconds());
}

void BridgeLcm::answer(snapwing_lcm::link_status_t& status) {
  const std::lock_guard<std::mutex> lock(greetings_mutex_);
  static_assert(sizeof status.answer_sender == Greetings::PLACES * sizeof status.answer_sender[0]);
  for (std::size_t i = 0; i < Greetings::PLACES; ++i) {
    status.answer_sender[i] = greetings_.all()[i].sender;
    status.answer_challenge[i] = greetings_.all()[i].challenge;
  }
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
    while (outbox_->pop(item)) publishOne(item);
  }
}

void BridgeLcm::publishOne(const Outbound& item) {
  Stamp stamp;
  stamp.sender_id = session_;
  stamp.session = session_;
  stamp.number = stamp.status_number = item.status.number;
  stamp.time = item.status.frame_time;
  stamp.expiry = STATUS_EXPIRY;
  const auto send = [this](const char* channel, const auto& message) {
    const std::vector<std::uint8_t> bytes = sealer_.wrap(channel, message);
    if (!bytes.empty()) out_.publish(channel, bytes.data(), bytes.size());
  };
  const std::int64_t unread = in_.fragments() + in_.malformed();
  snapwing_lcm::link_status_t status = toLcm(item.status, stamp, rejected_.load(std::memory_order_relaxed) + unread);
  answer(status);
  send(CHANNEL_STATUS, status);
  const bool measured = item.telemetry.imu.number != imu_number_;
  imu_number_ = item.telemetry.imu.number;
  if (!measured && item.status.number % TELEMETRY_EVERY != 0) return;
  stamp.number = ++telemetry_number_;
  send(CHANNEL_TELEMETRY, toLcm(item.telemetry, stamp, item.status.frame_time));
}

}  // namespace snapwing::link
