#pragma once
/// The radio bridge's LCM side: one thread checks what arrives and queues it for the loop, another publishes status.

#include <atomic>
#include <mutex>
#include <string>
#include <thread>

#include "bridge_loop.h"
#include "greetings.h"
#include "snapwing/common/loan.h"
#include "snapwing/link/lcm_socket.h"
#include "snapwing/link/sealing.h"
#include "snapwing_lcm/link_status_t.hpp"

namespace snapwing::link {

class BridgeLcm {
 public:
  /// @throws common::Error if the network refuses
  BridgeLcm(const std::string& url, const Sealer& sealer, std::int64_t session, Inbox& inbox, Outbox& outbox);
  ~BridgeLcm();
  BridgeLcm(const BridgeLcm&) = delete;
  BridgeLcm& operator=(const BridgeLcm&) = delete;

  /// The loop has put something into the outbox. Does not wait.
  void notify();
  /// Readable, for poll(), when messages have been put into the inbox; read it to clear.
  int arrivals() const { return arrival_; }

 private:
  void listen();
  void publish();
  void publishOne(const Outbound& item);
  void take(const LcmDatagram& datagram);
  template <class Wire, class Plain>
  bool queue(const LcmDatagram& datagram, Inbound::Kind kind, Plain Inbound::*member);
  bool greet(const LcmDatagram& datagram);
  void answer(snapwing_lcm::link_status_t& status);

  Sealer sealer_;
  LcmSocket in_;   ///< listener's
  LcmSocket out_;  ///< publisher's: its own, so that a flood of messages cannot hold up the status
  std::int64_t session_;
  common::Loan<Inbox> inbox_;
  common::Loan<Outbox> outbox_;
  std::atomic<bool> stop_{false};
  std::atomic<std::int64_t> rejected_{0};
  std::mutex greetings_mutex_;
  Greetings greetings_;
  std::int64_t telemetry_number_ = 0;
  std::int64_t imu_number_ = 0;  ///< of the last reading that was reported
  int event_ = -1, arrival_ = -1;
  std::thread listener_, publisher_;
};

}  // namespace snapwing::link
