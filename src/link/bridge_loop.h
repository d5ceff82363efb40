#pragma once
/// The radio bridge around its core: messages from a queue, frames to a line, answers of the flight controller, status
/// to a queue. One thread calls frame() and receive(); neither allocates, locks or waits.

#include <array>
#include <cstdint>
#include <memory>
#include <set>

#include "bridge_core.h"
#include "controller_watch.h"
#include "guardian.h"
#include "snapwing/common/loan.h"
#include "snapwing/link/transport.h"
#include "spsc_ring.h"

namespace snapwing::link {

enum class Protocol { MSP1, MSP2, SBUS, CRSF };
/// @param name  "msp1", "msp2", "sbus" or "crsf". @throws common::Error naming these
Protocol protocolFromName(const std::string& name);
/// Baud rate, parity and stop bits that the protocol asks for.
LineSettings lineSettings(Protocol protocol);

MspVersion mspVersion(Protocol protocol);
/// What the controller's answers are held against.
/// @param allowed  names of checks that need not pass. @throws common::SettingError for an unknown name
ControllerRules controllerRules(const BridgeSettings& settings, const std::set<std::string>& allowed);

/// One authenticated message on its way into the loop.
struct Inbound {
  enum class Kind { NONE, PULSE, HEARTBEAT, ABORT } kind = Kind::NONE;
  PulseCommand pulse;
  Heartbeat heartbeat;
  Abort abort;
};
/// What one frame left behind, on its way to the publisher.
struct Outbound {
  BridgeStatus status;
  ControllerTelemetry telemetry;
};
using Inbox = SpscRing<Inbound, 256>;
using Outbox = SpscRing<Outbound, 64>;

class BridgeLoop {
 public:
  /// @param readback  false: no questions to the controller (allowed by name only; always so with SBUS and CRSF)
  BridgeLoop(const BridgeSettings& settings, Protocol protocol, bool readback, const std::set<std::string>& allowed,
             Transport& transport, std::int64_t session, double now);

  Inbox& inbox() { return inbox_; }
  Outbox& outbox() { return outbox_; }
  BridgeCore& core() { return core_; }
  const ControllerWatch& watch() const { return watch_; }
  /// What the guardian looks at goes there, from the next frame on.
  void publishTo(std::shared_ptr<GuardianRecord> record);

  /// When the next frame is due: the core's grid, or earlier when a message has changed what must be sent and nothing
  /// is on its way that the controller would have to serve first.
  double nextFrameTime(double now) const;
  /// When takeIn() or frame() has something to do by itself.
  double nextWakeTime(double now) const;
  /// One frame: call when now >= nextFrameTime(now).
  void frame(double now);
  /// Takes messages and what the line has brought, without sending a frame.
  void takeIn(double now);

  /// Throttle low, AUX1 low, ready to send: for the guardian.
  static WireFrame safeFrame(Protocol protocol);

 private:
  static WireFrame encodeFrame(Protocol protocol, const Channels& channels);
  void drainInbox(double now);
  void receive(double now);
  void updateConnection(double now);
  bool windowOpen(double now);
  void ask(double now, bool always = false);
  double dueFrameTime(double now) const;
  bool proofDue(double now) const;

  Protocol protocol_;
  bool readback_;
  common::Loan<Transport> transport_;
  BridgeCore core_;
  ControllerWatch watch_;
  MspParser parser_;
  Inbox inbox_;
  Outbox outbox_;
  std::shared_ptr<GuardianRecord> record_ = std::make_shared<GuardianRecord>();  ///< its own, or the guardian's
  int seen_connections_ = 0;
  double window_closed_since_ = -1;
  double last_frame_ = -1e9;  ///< [s] written
  bool proof_asked_ = false;
  double proof_ = -1e9;  ///< [s] when a question asked since the last frame was answered
};

}  // namespace snapwing::link
