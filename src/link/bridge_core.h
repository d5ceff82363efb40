#pragma once
/// The radio bridge's state machine and frame clock, pure: no input or output, no clock of its own, no allocation.
///
///   state  | event                                             | next  | frames
///   -------+---------------------------------------------------+-------+----------------------------------
///   IDLE   | arm switch on (was off), deadman held, controller | ARMED | throttle low, AUX1 low
///          | known, connected, ready, disarmed                 |       |
///   ARMED  | pulse accepted and controller reports armed       | PULSE | throttle low, AUX1 high
///   ARMED  | switch off or deadman released                    | IDLE  |
///   PULSE  | own deadline                                      | ARMED | throttle of the pulse or its hold, AUX1 high
///   PULSE  | switch off or deadman released                    | IDLE  |
///   ARMED, PULSE | abort, heartbeat lost or late, line lost, telemetry lost, failsafe, frames missed, disarmed
///          | by itself, motors disagree, own loop stalled, clocks jumped, guardian lost, shutdown | FAULT |
///   FAULT  | reset with arm switch off, controller disarmed    | IDLE  | throttle low, AUX1 low
///
/// An abort or a shutdown latches FAULT from every state. With pilot_override AUX1 stays low in every state, ARMED
/// needs a controller that the pilot has armed with the override switch held, and letting go of either latches FAULT;
/// a reset is taken while the pilot is armed too, but only as long as he does not hold the override switch: then no
/// frame of ours reaches a motor, and the next arming needs his switch and the operator's again.
///
/// A command names the newest status that its sender had heard. Its age runs from the moment at which that status left,
/// by this bridge's clock; a status that was not sent, or not at that time, is a refusal.
///
/// A pulse's time runs from its first frame that the line took, so that waiting for the line does not shorten it. That
/// frame must leave before the command is too old, which bounds the end: stamp + min(max_age, expiry) + duration +
/// hold. Pulse and hold are one command: both were checked before the first frame, one clock ends both, and whatever
/// ends the pulse ends the hold with it. A frame leaves right at the change between them.

#include <array>

#include "snapwing/link/bridge_types.h"

namespace snapwing::link {

class BridgeCore {
 public:
  /// @param session  random number that names this run of the bridge
  /// @param now      [s] monotonic
  BridgeCore(const BridgeSettings& settings, std::int64_t session, double now);

  /// Messages, already authenticated. Each returns why it had no effect, or NONE; refusals are counted. A command
  /// takes effect with the next frame. @param now  [s] on the bridge's monotonic clock, here and below
  Refusal onPulse(const PulseCommand& command, double now);
  Refusal onHeartbeat(const Heartbeat& heartbeat, double now);
  Refusal onAbort(const Abort& abort, double now);
  void onController(const ControllerState& controller) { status_.controller = controller; }
  /// A guardian is alive and holds the line; without one nothing is armed. True until said otherwise.
  void onGuardian(bool guards) { guarded_ = guards; }
  /// The clocks of this computer moved against each other by this much [s]. Disarms.
  void onClockJump(double jump);

  /// When tick() is due next: the frame grid, brought forward to a pulse's deadline so that a pulse has its exact
  /// length.
  double nextFrameTime() const { return next_frame_; }
  /// A message has changed what must be sent: the next frame may come as early as earliestFrameTime(), if the line is
  /// free. The grid restarts from it.
  bool urgent() const { return urgent_; }
  double earliestFrameTime() const;
  /// [s] time from which an operator's silence disarms; infinite while nothing is armed.
  double silentFrom() const;
  /// A change of the pulse's throttle is so near that nothing may go out now which the controller would serve first.
  bool changesSoon(double now) const;
  /// A frame of a pulse was written, and the pulse is in force.
  bool inPulse() const { return status_.state == BridgeState::PULSE && pulse_begun_; }
  /// [s] while inPulse(): when its throttle changes next, by the hold's begin or by the end.
  double nextChange(double now) const;
  /// Advances the state machine and gives the channels to send now. Call at nextFrameTime(), or earlier if urgent().
  const Channels& tick(double now);
  /// The line took the frame of the last tick, or did not.
  void onSent(bool written, double now);
  /// What the process was granted; goes into the status.
  void noteGrants(bool realtime, bool memory_locked);

  /// Latches FAULT(SHUTDOWN). The caller keeps ticking until shutdownDone().
  void requestShutdown(double now);
  /// True once safe frames went out for the exit time, or could not be written for as long.
  bool shutdownDone(double now) const;

  const BridgeStatus& status() const { return status_; }
  std::int64_t session() const { return session_; }
  const BridgeSettings& settings() const { return settings_; }

 private:
  enum class Kind { PULSE = 0, HEARTBEAT = 1, ABORT = 2 };
  struct Sender {
    std::int64_t id = 0;
    std::array<std::int64_t, 3> last_number{};
    std::int64_t newest_status = 0;  ///< that a message of it has named
    double last_seen = -1e9;
    bool used = false;
    bool switch_off_seen = false;  ///< arm switch was off since the last disarming
    bool wished = false;           ///< arm switch on and deadman held in the last heartbeat
    bool reset_wished = true;      ///< reset_fault in the last heartbeat; true at first, so that an edge is needed
  };

  /// @param stops  the message can do nothing but end thrust, and may be of any age
  Refusal checkStamp(const Stamp& stamp, Kind kind, bool stops, double now, std::int64_t& detail);
  Refusal checkEcho(const Stamp& stamp, double now, std::int64_t& detail) const;
  bool knows(std::int64_t sender_id) const;
  Sender* findSender(std::int64_t id, double now);
  Refusal checkPulse(const PulseCommand& command, double now, std::int64_t& detail) const;
  Refusal checkArming(const Sender& sender, double now, std::int64_t& detail) const;
  Refusal wishToArm(const Heartbeat& heartbeat, Sender& sender, double now);
  Refusal resetFault(Sender& sender, double now);
  Refusal refuse(Refusal refusal, std::int64_t detail);
  void latch(Fault fault, std::int64_t detail);
  void disarm(Disarming why);
  void watch(double now);
  void watchController(double now);
  void advancePulse(double now);
  void composeChannels(double now);
  void notePeriod(double now);
  void noteLatency(double age);
  void beginPulse(double now);
  void endFrom(double start);
  bool inHold(double now) const;
  void schedule(double now);
  bool active() const { return status_.state == BridgeState::ARMED || status_.state == BridgeState::PULSE; }

  BridgeSettings settings_;
  std::int64_t session_;
  BridgeStatus status_;
  std::array<Sender, 8> senders_{};
  std::int64_t forgotten_status_ = -1;     ///< newest that a sender had named whose place another one has
  std::array<double, 64> status_times_{};  ///< [s] when the last statuses left, by number modulo size

  double next_frame_;                                          ///< [s]
  double last_tick_;                                           ///< [s] NaN before the first
  double wanted_period_;                                       ///< [s] what the last schedule asked for
  double worst_now_ = 0, worst_before_ = 0, worst_since_ = 0;  ///< two half-second windows

  std::int64_t operator_id_ = 0;  ///< sender that armed
  double last_heartbeat_ = -1e9;  ///< [s] of the operator while armed
  double armed_since_ = 0;
  bool controller_was_armed_ = false;
  double last_written_ = -1e9;

  bool has_pending_ = false;
  PulseCommand pending_;
  double pulse_start_ = 0, pulse_end_ = 0;
  double hold_start_ = 0;         ///< [s] from which the hold's throttle counts; without a hold the end
  bool pulse_begun_ = false;      ///< a frame of it was written
  double latest_start_ = 0;       ///< [s] after which its command is too old
  double late_heartbeat_ = -1e9;  ///< [s] when one of the operator's came too old
  std::int64_t late_by_ = 0;      ///< [us] its age
  bool guarded_ = true;
  double low_since_ = 0;  ///< throttle low sent since
  bool urgent_ = false;
  double shutdown_since_ = -1;
};

}  // namespace snapwing::link
