#pragma once
/// The radio bridge's LCM side: one thread checks what arrives and queues it for the loop, another publishes status.

#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "snapwing/link/bridge_loop.h"
#include "snapwing/link/sealing.h"

namespace snapwing::link {

class BridgeLcm {
 public:
  /// @throws common::Error if LCM cannot be started
  BridgeLcm(const std::string& url, const Key& key, std::int64_t session, Inbox& inbox, Outbox& outbox);
  ~BridgeLcm();
  BridgeLcm(const BridgeLcm&) = delete;
  BridgeLcm& operator=(const BridgeLcm&) = delete;

  /// The loop has put something into the outbox. Does not wait.
  void notify();
  /// Readable, for poll(), when messages have been put into the inbox; read it to clear.
  int arrivals() const { return arrival_; }

 private:
  struct Lcm;
  void listen();
  void publish();
  void publishOne(const Outbound& item);

  std::unique_ptr<Lcm> lcm_;
  Sealer sealer_;
  std::int64_t session_;
  Inbox& inbox_;
  Outbox& outbox_;
  std::atomic<bool> stop_{false};
  std::atomic<std::int64_t> rejected_{0};
  std::int64_t status_number_ = 0, telemetry_number_ = 0;
  int event_ = -1, arrival_ = -1;
  std::thread listener_, publisher_;
};

}  // namespace snapwing::link
