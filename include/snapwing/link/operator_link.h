#pragma once
/// The other end of the LCM link: hears the bridge and sends it commands, heartbeats and aborts. Used by
/// flight_link_node, the bench console and tests. Not thread-safe: one thread at a time.
///
/// A status counts only if it answers a challenge of ours that is no older than PROOF_AGE: a recording of a bridge that
/// has died is never taken for a living one. conflict() reports two living bridges for one vehicle.

#include <array>
#include <functional>
#include <string>

#include "snapwing/link/bridge_types.h"
#include "snapwing/link/lcm_socket.h"
#include "snapwing/link/sealing.h"
#include "snapwing_lcm/link_status_t.hpp"
#include "snapwing_lcm/telemetry_t.hpp"

namespace snapwing::link {

struct LinkCounters {
  std::int64_t statuses = 0;  ///< good ones
  std::int64_t rejected = 0;  ///< forged, malformed, of another version or vehicle, repeated
  std::int64_t unproven = 0;  ///< good seal, but no answer to a challenge of ours: recorded, or from before we began
  std::int64_t missed = 0;    ///< gaps in their numbers
  std::int64_t not_sent = 0;  ///< commands held back because no bridge was heard
};

class OperatorLink {
 public:
  using StatusCallback = std::function<void(const BridgeStatus& status)>;

  /// @throws common::Error if the network refuses
  OperatorLink(const std::string& url, const Sealer& sealer, StatusCallback on_status = {});

  /// Handles what arrives within the time, returns after the first message; asks the bridge whether it is there and
  /// repeats what must be repeated. Call it at least every few milliseconds. @param timeout  [s]
  void handle(double timeout);

  /// Each needs a bridge heard within BRIDGE_TIMEOUT, whose session and newest status go into the stamp.
  /// @return false if none was heard: nothing was sent
  bool sendPulse(std::int64_t pulse_id, const PulseShape& shape);
  /// While an abort is repeated, or two bridges are heard and none is armed, switch and deadman go out as off. One that
  /// ends the wish to be armed is repeated by handle() until the bridge shows that it was heard, so that a lost
  /// datagram costs milliseconds.
  bool sendHeartbeat(bool arm_switch, bool deadman, bool reset_fault);
  /// Aborts: now, and repeated by handle(), with switch and deadman off, until the bridge shows a fault or ABORT_TIME
  /// is over. Goes out to the last bridge known, also if it has not been heard lately.
  /// @param reason  snapwing_lcm::abort_t. @return false if no bridge was ever heard
  bool abort(int reason);
  bool aborting() const { return abort_reason_ != 0; }

  bool bridgeAlive() const;
  /// Another living bridge of this vehicle and key was heard within the last second.
  bool conflict() const;
  /// [s] since this end began to listen
  double listened() const;
  /// [s] since the last status arrived; infinite = never
  double statusAge() const;
  const BridgeStatus& status() const { return status_; }
  const snapwing_lcm::telemetry_t& telemetry() const { return telemetry_; }
  bool telemetryKnown() const { return telemetry_known_; }
  const LinkCounters& counters() const { return counters_; }
  std::int64_t messagesRejectedByBridge() const { return rejected_by_bridge_; }
  std::int64_t session() const { return session_; }
  const std::string& vehicleId() const { return sealer_.vehicleId(); }
  /// What else was heard in the last two seconds that explains why there is no good bridge; a sentence, or empty.
  std::string hint() const;

  static constexpr double BRIDGE_TIMEOUT = 0.2;  ///< [s]
  static constexpr double PROOF_AGE = 0.2;       ///< [s]
  static constexpr double COMMAND_EXPIRY = 0.1;  ///< [s]
  static constexpr double ABORT_TIME = 2.0;      ///< [s]

 private:
  struct Challenge {
    std::int64_t value = 0;
    double sent = -1e9;
  };
  struct Wish {
    bool arm = false, deadman = false, reset = false;
    bool active() const { return arm && deadman; }
  };

  void maintain(double now);
  double nextDue() const;
  void sayHello(double now);
  void repeatAbort(double now);
  void take(const LcmDatagram& datagram);
  void takeStatus(const snapwing_lcm::link_status_t& wire, double now);
  void takeTelemetry(const snapwing_lcm::telemetry_t& wire);
  bool answersUs(const snapwing_lcm::link_status_t& wire, double now) const;
  void note(const std::string& sentence, double now);
  bool stamp(Stamp& out, std::int64_t& number);
  bool beat(const Wish& wish);
  template <class Message>
  bool send(const char* channel, const Message& message);

  LcmSocket socket_;
  Sealer sealer_;
  StatusCallback on_status_;
  std::int64_t sender_id_;
  double began_;
  std::int64_t pulse_number_ = 0, heartbeat_number_ = 0, abort_number_ = 0;
  std::array<Challenge, 32> challenges_{};
  std::size_t next_challenge_ = 0;
  std::int64_t challenge_ = 0;  ///< the last one
  double next_hello_ = -1e9;
  std::int64_t session_ = 0, last_telemetry_number_ = 0;
  double heard_ = -1e9;        ///< [s] own clock, when the last status arrived
  double other_heard_ = -1e9;  ///< [s] when another living bridge was heard
  Wish wish_;
  double repeat_until_ = -1e9, next_repeat_ = 0;  ///< of a heartbeat that ends the wish
  int abort_reason_ = 0;                          ///< 0 = none under way
  double abort_since_ = 0;
  std::int64_t abort_after_ = 0;  ///< status number when the abort began
  BridgeStatus status_;
  snapwing_lcm::telemetry_t telemetry_{};
  bool telemetry_known_ = false;
  std::int64_t rejected_by_bridge_ = 0;
  LinkCounters counters_;
  std::string hint_;
  double hint_time_ = -1e9;
};

}  // namespace snapwing::link
