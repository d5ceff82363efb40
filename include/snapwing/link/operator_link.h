#pragma once
/// The other end of the LCM link: hears the bridge and sends it commands, heartbeats and aborts. Used by
/// flight_link_node, the bench console and tests. Not thread-safe: one thread at a time.

#include <functional>
#include <memory>
#include <string>

#include "snapwing/link/bridge_types.h"
#include "snapwing/link/controller_watch.h"
#include "snapwing/link/sealing.h"
#include "snapwing_lcm/telemetry_t.hpp"

namespace snapwing::link {

struct LinkCounters {
  std::int64_t statuses = 0;  ///< good ones
  std::int64_t rejected = 0;  ///< forged, malformed, of another version, repeated
  std::int64_t missed = 0;    ///< gaps in their numbers
  std::int64_t not_sent = 0;  ///< commands held back because no bridge was heard
};

class OperatorLink {
 public:
  using StatusCallback = std::function<void(const BridgeStatus& status)>;

  /// @throws common::Error if LCM cannot be started
  OperatorLink(const std::string& url, const Key& key, StatusCallback on_status = {});
  ~OperatorLink();

  /// Handles what arrives within the time; returns after the first message. @param timeout  [s]
  void handle(double timeout);

  /// Each needs a bridge heard within BRIDGE_TIMEOUT, whose session and clock go into the stamp.
  /// @return false if none was heard: nothing was sent
  bool sendPulse(std::int64_t pulse_id, double throttle, double duration, double pitch = 0.0, bool mixed = false);
  bool sendHeartbeat(bool arm_switch, bool deadman, bool reset_fault);
  bool sendAbort(int reason);

  bool bridgeAlive() const;
  /// [s] since the last status arrived; infinite = never
  double statusAge() const;
  const BridgeStatus& status() const { return status_; }
  const snapwing_lcm::telemetry_t& telemetry() const { return telemetry_; }
  bool telemetryKnown() const { return telemetry_known_; }
  const LinkCounters& counters() const { return counters_; }
  std::int64_t messagesRejectedByBridge() const { return rejected_by_bridge_; }
  std::int64_t session() const { return session_; }

  static constexpr double BRIDGE_TIMEOUT = 0.2;  ///< [s]
  static constexpr double COMMAND_EXPIRY = 0.1;  ///< [s]

 private:
  struct Lcm;
  void noteClock(double now, double bridge_time, bool new_session);
  bool stamp(Stamp& out, std::int64_t& number);
  template <class Message>
  bool send(const char* channel, const Message& message);

  std::unique_ptr<Lcm> lcm_;
  Sealer sealer_;
  StatusCallback on_status_;
  std::int64_t sender_id_;
  std::int64_t pulse_number_ = 0, heartbeat_number_ = 0, abort_number_ = 0;
  std::int64_t session_ = 0, last_status_number_ = 0;
  double heard_ = -1e9;  ///< [s] own clock, when the last status arrived
  /// [s] own clock minus the bridge's, the smallest seen in this second and the last: the status that took least time
  /// to come here tells the bridge's clock best, and never makes a stamp run ahead of it.
  double offset_now_ = 0, offset_before_ = 0, offset_since_ = 0;
  BridgeStatus status_;
  snapwing_lcm::telemetry_t telemetry_{};
  bool telemetry_known_ = false;
  std::int64_t rejected_by_bridge_ = 0;
  LinkCounters counters_;
};

}  // namespace snapwing::link
