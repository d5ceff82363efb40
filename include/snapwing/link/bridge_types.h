#pragma once
/// What goes into the radio bridge and what comes out: plain data of fixed size, so that its loop allocates nothing.
/// Times are seconds on the bridge's own monotonic clock.

#include <array>
#include <cstdint>
#include <limits>
#include <string>

#include "snapwing/link/channels.h"
#include "snapwing/link/imu_question.h"

namespace snapwing::link {

/// Where a command comes from and how long it holds; already authenticated.
struct Stamp {
  std::int64_t sender_id = 0;
  std::int64_t session = 0;
  std::int64_t number = 0;
  double time = 0;                 ///< [s] in the newest status that the sender had heard, on the bridge's clock
  double expiry = 0;               ///< [s] good for this long after it
  std::int64_t status_number = 0;  ///< that status; `time` must be its own
  double held = 0;                 ///< [s] from then to sending, by the sender's clock: for statistics only
};

/// What a pulse command asks for: one level of throttle, then perhaps a second one (the hold), then throttle low.
struct PulseShape {
  double throttle = 0;       ///< [0, 1]
  double duration = 0;       ///< [s]
  double hold_throttle = 0;  ///< [0, 1] behind it; 0 with a hold_duration of 0, else above 0
  double hold_duration = 0;  ///< [s] 0 = no hold
  double pitch = 0;          ///< [-1, 1] during `duration`; centred in the hold
  bool mixed = false;        ///< pitch is used too
  double whole() const { return duration + hold_duration; }  ///< [s]
};

struct PulseCommand : PulseShape {
  Stamp stamp;
  std::int64_t pulse_id = 0;
};

struct Heartbeat {
  Stamp stamp;
  bool arm_switch = false;
  bool deadman = false;
  bool reset_fault = false;
};

struct Abort {
  Stamp stamp;
  int reason = 0;
};

enum class BridgeState : std::uint8_t { UNKNOWN = 0, IDLE = 1, ARMED = 2, PULSE = 3, FAULT = 4 };
/// "idle", "armed", ...
const char* stateName(BridgeState state);

/// Why the bridge latched a fault.
enum class Fault : std::int32_t {
  NONE = 0,
  ABORTED = 1,                ///< detail: reason of the abort
  HEARTBEAT_LOST = 2,         ///< while armed
  LINE_LOST = 3,              ///< connection closed or blocked while armed
  CONTROLLER_FAILSAFE = 4,    ///< while armed
  CONTROLLER_DISARMED = 5,    ///< by itself; detail: arming-disable flags
  CONTROLLER_NOT_ARMING = 6,  ///< not armed in time; detail: arming-disable flags
  TELEMETRY_LOST = 7,         ///< while armed
  LOOP_STALLED = 8,           ///< the bridge itself was stopped while armed; detail: [us] gap
  SHUTDOWN = 9,               ///< the bridge is about to end
  MOTORS_DISAGREE = 10,       ///< motors above idle while throttle low is sent; detail: [us] largest output
  PILOT_TOOK_OVER = 11,       ///< the pilot let go of the override switch
  OPERATOR_LATE = 12,         ///< heartbeats come, but too old; detail: [us] age of the last one
  GUARDIAN_LOST = 13,         ///< the process that would end a pulse in the bridge's place is gone
  CLOCKS_DISAGREE = 14,       ///< a clock jumped or stood still while armed (suspended, paused); detail: [us]
  CONTROLLER_RXLOSS = 15,     ///< the controller misses frames while armed; detail: arming-disable flags
};

/// Why a message had no effect.
enum class Refusal : std::int32_t {
  NONE = 0,
  WRONG_SESSION = 1,
  STALE = 2,            ///< detail: [us] age
  FROM_FUTURE = 3,      ///< detail: [us] age, negative
  REPEATED_NUMBER = 4,  ///< detail: number
  REPEATED_PULSE = 5,   ///< detail: pulse id
  BAD_VALUE = 6,        ///< not finite or outside the allowed range, the pulse id too
  NOT_ARMED = 7,
  BUSY = 8,            ///< a pulse is in force, or the pause after the last one is not over
  OTHER_OPERATOR = 9,  ///< another sender holds the deadman
  TOO_MANY_SENDERS = 10,
  MIXED_NOT_ALLOWED = 11,
  LATCHED_FAULT = 12,         ///< detail: fault
  NOT_CONNECTED = 13,         ///< detail: [us] slowest answer of a controller that answers too slowly; 0 = no answer
  CONTROLLER_UNKNOWN = 14,    ///< identity or settings not read yet, or unsafe; detail: check
  CONTROLLER_NOT_READY = 15,  ///< detail: arming-disable flags
  CONTROLLER_FAILSAFE = 16,
  SWITCH_NOT_CYCLED = 17,  ///< the arm switch has not been off yet
  PILOT_NOT_READY = 18,    ///< override: the pilot has not armed or does not hold the override switch
  UNKNOWN_STATUS = 19,     ///< names a status that this bridge has not sent; detail: its number
  RESET_WHILE_ARMED = 20,  ///< the controller is armed; with override: and the pilot still holds the switch
  NO_GUARDIAN = 30,        ///< the guardian is gone or does not hold this line yet
};
/// Plain sentences for logs and messages, e.g. "command is 130 ms old, limit 100 ms".
std::string describe(Fault fault, std::int64_t detail);
std::string describe(Refusal refusal, std::int64_t detail);
/// Why commands reckoned with one scale must not go out by another; empty if they agree within half a microsecond.
std::string scaleMismatch(const common::ThrottleScale& bridge, const common::ThrottleScale& vehicle);
/// "RXLOSS BOOTGRACE" from a mask of Betaflight 4.5's arming-disable bits.
std::string describeArmingFlags(std::uint32_t flags);

/// Largest id of a pulse: what ROS messages hold. One id beyond it would make all that ROS can send a repetition.
constexpr std::int64_t MAX_PULSE_ID = 4294967295;

/// Why ARMED or PULSE became IDLE without a fault.
enum class Disarming : std::uint8_t { NONE = 0, SWITCH_OFF = 1, DEADMAN_RELEASED = 2 };
const char* describe(Disarming disarming);

/// Bit of the arming-disable flags that says: no good frames. The same in all releases that are accepted.
constexpr std::uint32_t RXLOSS_FLAG = 1U << 2;

/// What the flight controller said, as far as the bridge's logic needs it.
struct ControllerState {
  bool connected = false;
  bool known = false;         ///< identity and settings read and found safe, or allowed by name
  bool readback = true;       ///< false: no telemetry on this line; allowed by name only
  int failed_check = 0;       ///< first check not passed
  double slowest_answer = 0;  ///< [s] since the connection
  bool armed = false;
  bool failsafe = false;
  bool override_active = false;  ///< the pilot holds the override switch
  std::uint32_t arming_flags = 0;
  int motor_max = 0;  ///< [us] largest motor output; 0 = not read
  double motor_time = -std::numeric_limits<double>::infinity();
  double status_time = -std::numeric_limits<double>::infinity();  ///< [s] when status was last received
};

struct BridgeSettings {
  double frame_period = 0.02;       ///< [s] 0.007..0.05
  double max_age = 0.1;             ///< [s] commands older than this are dropped
  double future_tolerance = 0.005;  ///< [s] how far a stamp may run ahead
  double heartbeat_timeout = 0.2;   ///< [s] 0.04..0.25
  double max_throttle = 1.0;        ///< [1] larger commands are refused
  double max_pulse = 1.5;           ///< [s] longer commands are refused; pulse and hold together
  double min_rest = 0.1;            ///< [s] between pulses
  double throttle_rise = 0.0;       ///< [s] ramp from low to full; 0 = step. Falling is never ramped
  double max_pitch = 0.0;           ///< [1] stick; 0 = mixed control not allowed
  double arm_timeout = 1.0;         ///< [s] controller must report armed within
  double telemetry_timeout = 1.0;   ///< [s] age of its status while armed
  double stall_limit = 0.1;         ///< [s] own loop late by more than this while armed latches a fault
  double line_timeout = 0.1;        ///< [s] nothing could be written while armed: fault
  double motor_check_delay = 0.6;   ///< [s] after throttle low, read-back motors must be at idle
  int motor_idle_limit = 1120;      ///< [us] above this is not idle
  double exit_time = 0.3;           ///< [s] throttle low and AUX1 low sent on shutdown, at least 0.2
  /// The pilot's receiver leads; these frames count on masked channels only, while the pilot's switch allows it. The
  /// pilot arms, AUX1 is always sent low, and letting go of the switch ends everything.
  bool pilot_override = false;
  ImuSettings imu;                 ///< the flight controller's accelerometer
  common::ThrottleScale throttle;  ///< of the vehicle file; the operator must have the same
  /// Takes the scale and the limit of idle motors from a vehicle file's `radio`.
  void useScale(const common::ThrottleScale& scale);
  /// @throws common::SettingError naming the key
  void validate() const;
};

constexpr int HISTOGRAM_BINS = 10;
using Histogram = std::array<std::int64_t, HISTOGRAM_BINS>;
/// Upper edges of all but the last bin [s].
constexpr std::array<double, HISTOGRAM_BINS - 1> HISTOGRAM_EDGES = {1e-4, 2e-4, 5e-4, 1e-3, 2e-3,
                                                                    5e-3, 1e-2, 2e-2, 5e-2};

struct BridgeStatus {
  std::int64_t number = 0;  ///< counts the frames up
  BridgeState state = BridgeState::IDLE;
  Fault fault = Fault::NONE;
  std::int64_t fault_detail = 0;
  std::int64_t pulse_id = 0;
  double commanded_throttle = 0;
  Channels channels;
  double frame_time = 0;  ///< [s]
  std::int64_t frames_sent = 0;
  std::int64_t frames_dropped = 0;
  std::int64_t commands_accepted = 0;
  std::int64_t commands_refused = 0;
  Refusal last_refusal = Refusal::NONE;
  std::int64_t last_refusal_detail = 0;
  double period_worst = 0;         ///< [s] over the last second
  Histogram period_histogram{};    ///< how far each frame of the grid missed its time
  Histogram latency_histogram{};   ///< command stamped -> its first frame
  double latency_worst = 0;        ///< [s]
  common::ThrottleScale throttle;  ///< by which commands reach the wire
  bool realtime = false;           ///< the loop has real-time priority
  bool memory_locked = false;
  Disarming last_disarming = Disarming::NONE;
  ControllerState controller;
  double telemetry_age = -1;  ///< [s]; negative = never
};

}  // namespace snapwing::link
