#pragma once
/// What one mode switch does after its plan: ready, send, watch, settle, and send again if the pulse was not taken.
/// Pure: from what is known and the time of a steady clock it decides the next action; the carrier of messages polls
/// it.
///
/// | state    | event           | next     | outcome     | when |
/// |----------|-----------------|----------|-------------|------------------------------------------------------------|
/// | READY    | STOP_ASKED      | DONE     | PREEMPTED   | somebody withdrew the goal |
/// | READY    | SOMETHING_LACKS | DONE     | NOT_READY   | missing() names one thing or more |
/// | READY    | ALL_THERE       | SENT     |             | action SEND |
/// | SENT     | LINK_FAILED     | DONE     | LINK_LOST   | no fresh status, a fault, failsafe, disarmed |
/// | SENT     | STOP_ASKED      | DONE     | PREEMPTED   | the bridge ends the pulse by its own clock |
/// | SENT     | TAKEN           | RUNNING  |             | the status shows the pulse's id |
/// | SENT     | REFUSED         | DONE     | NOT_READY   | the status counts one refusal more |
/// | SENT     | LOST_ON_THE_WAY | READY    |             | accept_timeout is over, the status is newer than the |
/// |          |                 |          |             | command can live and shows another id; attempts are left |
/// | SENT     | NEVER_TAKEN     | DONE     | LINK_LOST   | likewise, no attempts left |
/// | RUNNING  | LINK_FAILED     | DONE     | LINK_LOST   | |
/// | RUNNING  | STOP_ASKED      | DONE     | PREEMPTED   | |
/// | RUNNING  | ENDED           | SETTLING |             | its time is over and the bridge sends no pulse |
/// | RUNNING  | DOES_NOT_END    | DONE     | LINK_LOST   | the bridge still sends it accept_timeout later |
/// | SETTLING | LINK_FAILED     | DONE     | LINK_LOST   | |
/// | SETTLING | STOP_ASKED      | DONE     | PREEMPTED   | |
/// | SETTLING | STAYED          | DONE     | SUCCEEDED   | readings have shown the target mode for settle_hold |
/// | SETTLING | STAYED_AWAY     | DONE     | WRONG_MODE  | settle_timeout is over, readings show the starting mode |
/// | SETTLING | NOTHING_SEEN    | DONE     | NOT_SETTLED | settle_timeout is over, the mode is not known |
///
/// Where several events hold, the first one in this table counts. Events without a row have no effect.

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "snapwing/vehicle/mode.h"

namespace snapwing::planning {

enum class SwitchState { READY, SENT, RUNNING, SETTLING, DONE };

enum class SwitchEvent {
  STOP_ASKED,
  SOMETHING_LACKS,
  ALL_THERE,
  LINK_FAILED,
  TAKEN,
  REFUSED,
  LOST_ON_THE_WAY,
  NEVER_TAKEN,
  ENDED,
  DOES_NOT_END,
  STAYED,
  STAYED_AWAY,
  NOTHING_SEEN,
  NOTHING,
};

enum class SwitchOutcome { NONE, SUCCEEDED, NOT_READY, LINK_LOST, WRONG_MODE, NOT_SETTLED, PREEMPTED };

/// What the caller has to do now.
enum class SwitchAction { WAIT, SEND, FINISH };

struct SwitchRow {
  SwitchState from;
  SwitchEvent event;
  SwitchState to;
  SwitchOutcome outcome;
};

struct SwitchSettings {
  double fresh = 0.5;           ///< [s] 0.05 .. 5, older status, estimate or IMU reading counts as lost
  double accept_timeout = 0.5;  ///< [s] 0.3 .. 5, the bridge must have taken the pulse within this time
  double settle_timeout = 4.0;  ///< [s] 0.1 .. 30, after the pulse's end
  double settle_hold = 0.3;     ///< [s] 0 .. 5, the estimate must stay in the target mode for this long
  int attempts = 2;             ///< [1] 1 .. 5, how often a pulse is sent that is not taken
  double command_life = 0.15;   ///< [s] no command is taken when it is older than this
  void validate() const;        ///< @throws common::Error naming the member
};

/// What is known at one moment. Ages [s] are infinite where nothing came.
struct SwitchView {
  enum class Bridge { UNKNOWN, IDLE, ARMED, PULSE, FAULT };

  double now = 0;           ///< [s] steady clock
  bool stop_asked = false;  ///< the goal was withdrawn, or the program ends
  double link_age = std::numeric_limits<double>::infinity();
  std::string link_trouble;  ///< why the status is not fresh, e.g. "never came"; only read if it is not
  Bridge bridge = Bridge::UNKNOWN;
  std::string bridge_fault;
  bool controller_connected = false;
  bool controller_armed = false;
  bool controller_failsafe = false;
  std::uint32_t pulse_id = 0;  ///< pulse that is or was last sent by the bridge
  std::uint64_t refused = 0;   ///< commands refused so far
  std::string last_refusal;
  double mode_age = std::numeric_limits<double>::infinity();
  std::string mode_trouble;  ///< why the estimate is not fresh; only read if it is not
  vehicle::Mode mode = vehicle::Mode::UNKNOWN;
  std::string mode_reason;  ///< why the estimate says UNKNOWN
  /// [s] of the newest IMU reading in the estimate, now
  double reading_age = std::numeric_limits<double>::infinity();
};

class SwitchProtocol {
 public:
  /// @param target    F or Q
  /// @param duration  of the pulse [s]
  /// @param first_id  of the pulse, or the next one that the bridge has not seen; an attempt more takes the next number
  /// @throws common::Error for bad settings or an UNKNOWN target
  SwitchProtocol(const SwitchSettings& settings, vehicle::Mode target, double duration, std::uint32_t first_id);

  /// The whole protocol, for tests and documents.
  static const std::vector<SwitchRow>& table();
  /// Everything that a switch to `target` lacks, in words; empty if it may begin.
  static std::vector<std::string> missing(const SwitchSettings& settings, const SwitchView& view, vehicle::Mode target);
  /// One sentence of missing(); empty if nothing is.
  static std::string missingText(const std::vector<std::string>& missing);

  /// After SEND the caller sends the pulse under id() at once.
  SwitchAction step(const SwitchView& view);

  SwitchState state() const { return state_; }
  std::uint32_t id() const { return id_; }
  int attempts() const { return attempts_; }
  SwitchOutcome outcome() const { return outcome_; }
  const std::string& message() const { return message_; }
  /// [s] from the pulse's sending until the estimate reached the target mode to stay; NaN = it did not
  double switchSeconds() const { return switch_seconds_; }

 private:
  /// The event that holds now; may note since when the target mode is seen.
  SwitchEvent eventOf(const SwitchView& view);
  SwitchEvent sentEvent(const SwitchView& view) const;
  SwitchEvent settlingEvent(const SwitchView& view);
  std::string messageOf(SwitchEvent event, const SwitchView& view) const;

  SwitchSettings settings_;
  vehicle::Mode target_;
  double duration_;
  SwitchState state_ = SwitchState::READY;
  SwitchOutcome outcome_ = SwitchOutcome::NONE;
  std::string message_;
  std::uint32_t id_;
  int attempts_ = 0;
  double sent_ = 0;     ///< [s] steady clock
  double ended_ = 0;    ///< [s]
  double reached_ = 0;  ///< [s] since when the target mode is seen
  bool there_ = false;
  std::uint64_t refused_before_ = 0;
  double switch_seconds_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace snapwing::planning
