#pragma once
/// The guardian: a second small process that ends a pulse when the bridge cannot. Here its logic, pure and without a
/// clock: it counts its own wakings, so that a machine that stood still as a whole is no false alarm.
///
///   state    | event                                              | next     | does
///   ---------+----------------------------------------------------+----------+--------------------------------------
///   WATCHING | armed, and no frame in still_limit wakings         | KILLING  | SIGKILL to the bridge
///   WATCHING | bridge ended in order, or without an open line     | FINISHED |
///   WATCHING | bridge ended otherwise                             | SENDING  | clears the line, first safe frame
///   KILLING  | bridge ended, or kill_patience wakings later       | SENDING  | clears the line, first safe frame
///   SENDING  | every wakings_per_frame                            |          | a safe frame
///   SENDING  | nothing taken in blocked_limit wakings             |          | clears the line, a safe frame
///   SENDING  | least_frames in least_wakings taken, line empty    | FINISHED |
///   SENDING  | line broken (hung up, closed)                      | FINISHED | the controller's failsafe does the rest
///
/// Nothing leads back: a guardian that has taken over never hands the line on. The safe frame is throttle low, AUX1
/// low; under the pilot's override the controller takes of it what its mask allows.

#include <atomic>
#include <cstdint>

namespace snapwing::link {

/// What bridge and guardian tell each other in memory that both map.
struct GuardianRecord {
  std::atomic<std::uint64_t> beat{0};        ///< moves with each turn of the loop that sends frames
  std::atomic<std::uint32_t> open_bytes{0};  ///< of a frame that may be on the line in part
  std::atomic<bool> active{false};           ///< AUX1 high or thrust may be in force: from before such a frame is
                                             ///< written until a safe one is
  std::atomic<bool> orderly_end{false};      ///< the bridge has sent its safe frames and ends
  std::atomic<std::uint64_t> guardian_beat{0};
  std::atomic<std::int32_t> guarded_connection{0};   ///< connection whose descriptor the guardian holds; 0 = none
  std::atomic<bool> realtime{false}, locked{false};  ///< what the guardian was granted
};
static_assert(std::atomic<std::uint64_t>::is_always_lock_free, "shared between processes");

struct GuardianSettings {
  double waking = 0.005;      ///< [s] asked of the kernel between two wakings
  int still_limit = 12;       ///< wakings: 60 ms
  int kill_patience = 20;     ///< wakings; a bridge caught inside the kernel writes nothing new either
  int wakings_per_frame = 4;  ///< 20 ms
  int blocked_limit = 20;     ///< wakings: 0.1 s
  int least_wakings = 200;    ///< 1 s; the controller disarms 0.1 s after the first safe frame
  int least_frames = 25;      ///< taken by the line
  /// For a bridge with this frame period [s]: the limit leaves 40 ms beyond a period.
  static GuardianSettings forPeriod(double frame_period);
};

/// What the guardian sees at a waking.
struct GuardianSeen {
  bool waking = true;  ///< its time was over; false: something came in between
  std::uint64_t beat = 0;
  bool active = false;
  bool bridge_ended = false;
  bool orderly_end = false;
  bool line_open = false;
  int backlog = 0;  ///< [bytes] that the line has not taken yet
};

enum class GuardianAction { NONE, KILL, CLEAR_AND_SEND, SEND, FINISHED };
enum class GuardianReason { NONE = 0, BRIDGE_DIED = 1, BRIDGE_STOOD_STILL = 2 };

class GuardianCore {
 public:
  explicit GuardianCore(const GuardianSettings& settings) : settings_(settings) {}
  GuardianAction step(const GuardianSeen& seen);
  /// The line took the safe frame of the last action, or did not.
  void onSent(bool taken);

  GuardianReason reason() const { return reason_; }
  int frames() const { return frames_; }    ///< taken by the line
  int wakings() const { return wakings_; }  ///< since it took over
  bool sending() const { return state_ == State::SENDING; }

 private:
  enum class State { WATCHING, KILLING, SENDING, FINISHED };
  GuardianAction watch(const GuardianSeen& seen);
  GuardianAction send(const GuardianSeen& seen);
  GuardianAction takeOver(const GuardianSeen& seen);

  GuardianSettings settings_;
  State state_ = State::WATCHING;
  GuardianReason reason_ = GuardianReason::NONE;
  std::uint64_t beat_ = 0;
  int still_ = 0, waited_ = 0;
  int wakings_ = 0, frames_ = 0, untaken_ = 0;
};

}  // namespace snapwing::link
