#pragma once
/// What an operator's request (arm, disarm, reset, abort) makes of arm switch and reset flag, and how it ends. Pure: no
/// messages, no clock of its own. "Armed" is the bridge's ARMED or PULSE.
///
///   state       | event                                            | next        | switch | answer
///   ------------+--------------------------------------------------+-------------+--------+-------------------------
///   not ABORT   | arm asked, armed and controller armed already    | ON          | on     | armed
///   not ABORT   | arm asked                                        | CYCLE       | off    |
///   CYCLE       | a bridge heard, alone, long enough, deadman held,| ASK         | on     |
///               | switch shown off for cycle_time                  |             |        |
///   CYCLE       | two bridges heard                                | OFF         | off    | refused, why
///   CYCLE       | cycle_time and answer_time over                  | OFF         | off    | refused, what is missing
///   ASK         | bridge armed                                     | CONFIRM     | on     |
///   ASK         | bridge refuses, or answer_time over              | OFF         | off    | refused, why
///   CONFIRM     | controller armed                                 | ON          | on     | armed
///   CONFIRM     | bridge no longer armed, or arm_timeout over      | OFF         | off    | refused, why
///   ON          | bridge no longer armed                           | OFF         | off    |
///   not ABORT   | disarm asked                                     | DISARM      | off    |
///   DISARM      | bridge heard, not armed                          | OFF         | off    | disarmed
///   DISARM      | answer_time over                                 | OFF         | off    | not confirmed
///   not ABORT   | reset asked                                      | RESET_CYCLE | off    |
///   RESET_CYCLE | switch shown off for cycle_time                  | RESET       | off    | (reset flag up)
///   RESET       | bridge heard, no fault                           | OFF         | off    | no fault
///   RESET       | bridge refuses, or answer_time over              | OFF         | off    | refused, why
///   any         | abort asked                                      | ABORT       | off    | (deadman off too)
///   ABORT       | bridge shows a fault                             | OFF         | off    | aborted
///   ABORT       | abort_time over                                  | OFF         | off    | not confirmed
///   ABORT       | anything else asked                              | ABORT       | off    | refused
///
/// A request takes the place of the one before, which is answered as overtaken.

#include <array>
#include <cstdint>
#include <string>

#include "snapwing/link/bridge_types.h"

namespace snapwing::link {

/// All in [s].
struct ArmingTimes {
  double cycle_time = 0.06;  ///< switch shown off before it is shown on
  double listen_time = 0.4;  ///< listened for other bridges before anything is armed
  double answer_time = 0.6;  ///< for the bridge to answer
  double arm_timeout = 1.2;  ///< for the flight controller to report armed
  double abort_time = 2.0;   ///< for the bridge to show the fault
};

/// What is known of the other side.
struct LinkView {
  bool alive = false;         ///< a bridge is heard
  bool conflict = false;      ///< two are heard
  double listened = 0;        ///< [s]
  bool deadman_held = false;  ///< at our end
  std::string hint;           ///< what else is heard; may be empty
  BridgeStatus status;        ///< newest
};

struct ArmingAnswer {
  bool success = false;
  std::string message;
};

class ArmingProtocol {
 public:
  enum class Request { ARM, DISARM, RESET, ABORT };
  enum class State { OFF, CYCLE, ASK, CONFIRM, ON, DISARM, RESET_CYCLE, RESET, ABORT };

  explicit ArmingProtocol(const ArmingTimes& times = {}) : times_(times) {}

  /// @return the ticket under which the answer will lie
  std::int64_t ask(Request request, const LinkView& view, double now);
  /// Call with every news of the link, and at least every few milliseconds.
  void step(const LinkView& view, double now);

  State state() const { return state_; }
  bool armSwitch() const { return state_ == State::ASK || state_ == State::CONFIRM || state_ == State::ON; }
  bool resetFlag() const { return state_ == State::RESET; }
  /// Whether a deadman that is held may be shown as held.
  bool deadmanAllowed() const { return state_ != State::ABORT; }
  /// @return true, and the answer, once the request is over; the last 16 are kept
  bool answer(std::int64_t ticket, ArmingAnswer& out) const;

 private:
  struct Kept {
    std::int64_t ticket = 0;
    ArmingAnswer answer;
  };
  void enter(State state, double now);
  void finish(State state, bool success, const std::string& message, double now);
  void keep(std::int64_t ticket, bool success, const std::string& message);
  void stepCycle(const LinkView& view, double now);
  void stepAsk(const LinkView& view, double now);
  void stepConfirm(const LinkView& view, double now);
  void stepReset(const LinkView& view, double now);
  void stepAbort(const LinkView& view, double now);
  bool refusedSince(const LinkView& view) const;

  ArmingTimes times_;
  State state_ = State::OFF;
  double since_ = 0;                 ///< [s] in this state
  std::int64_t last_ticket_ = 0;     ///< given out
  std::int64_t ticket_ = 0;          ///< of the request that is carried out
  bool open_ = false;                ///< it is not answered yet
  std::int64_t refused_before_ = 0;  ///< bridge's count when the state was entered
  std::int64_t number_before_ = 0;   ///< bridge's status then
  std::array<Kept, 16> kept_{};
};

}  // namespace snapwing::link
