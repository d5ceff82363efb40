#pragma once
/// Checks of clocks and message stamps, the same for all programs. Callers pass the times of two clocks; none is read
/// here: `now`, the clock of message stamps (ROS time: a wall clock that may be set, or a simulated one; 0 = none yet),
/// and `steady`, which is monotonic. All times in s.
///
/// | what happens                                   | ClockWatch::look | StampWatch::take |
/// |------------------------------------------------|------------------|------------------|
/// | there is no clock yet                          | MISSING          | NO_CLOCK         |
/// | the clock advances, or stands                  | ON               |                  |
/// | the clock is set back by more than `tolerance` | BACK             |                  |
/// | it runs ahead of `steady` by more than that    | AHEAD            |                  |
/// | the stamp is not above 0, or not finite        |                  | UNSTAMPED        |
/// | the stamp lies more than `ahead` after now     |                  | FUTURE           |
/// | the stamp lies more than `stale` before now    |                  | STALE            |
/// | the stamp equals that of the last good message |                  | REPEATED         |
/// | the stamp lies before that                     |                  | OLDER            |
///
/// After BACK and AHEAD all earlier times are invalid: restart() every StampWatch and everything that depends on time.

#include <array>
#include <limits>
#include <string>

namespace snapwing::common {

enum class ClockEvent { MISSING, ON, BACK, AHEAD };

/// Detects jumps of a clock.
class ClockWatch {
 public:
  /// @param tolerance  [s] above 0. @throws Error otherwise
  explicit ClockWatch(double tolerance = 0.5);

  /// Call it often, with both clocks read at the same moment [s].
  ClockEvent look(double now, double steady);

  unsigned jumps() const { return jumps_; }

 private:
  double tolerance_;
  double latest_ = 0;  ///< 0 = none yet
  double steady_ = 0;
  unsigned jumps_ = 0;
};

enum class StampVerdict { GOOD, NO_CLOCK, UNSTAMPED, FUTURE, STALE, REPEATED, OLDER };
constexpr std::size_t STAMP_VERDICTS = 7;

struct StampLimits {
  double stale = 0.5;   ///< [s]
  double ahead = 0.25;  ///< [s] clocks of two programs may differ by this
};

/// Checks the stamps of one stream of messages. Only GOOD messages should be used.
class StampWatch {
 public:
  /// @throws Error unless both limits are above 0
  explicit StampWatch(const StampLimits& limits = {});

  /// Verdict on a message that is received now, counted. All times in s.
  StampVerdict take(double stamp, double now, double steady);

  /// Age of the last good message [s]: the larger one of the times since its stamp and since its reception, so that its
  /// age also grows while the clock stands. Infinite if there is none.
  double age(double now, double steady) const;
  /// Discards the last message, not the counts.
  void restart();

  /// Stamp of the last good message [s]; 0 if there is none.
  double last() const { return last_; }
  unsigned long count(StampVerdict verdict) const { return counts_[static_cast<std::size_t>(verdict)]; }
  /// Fault of the stream in words: "never came", "stopped 1.2 s ago", "is stamped 3.0 s ahead of the clock". Empty if
  /// the last good message is not older than `oldest` [s].
  std::string trouble(double now, double steady, double oldest) const;

 private:
  StampLimits limits_;
  double last_ = 0;
  double came_ = -std::numeric_limits<double>::infinity();     ///< `steady` of the last good message
  double refused_ = -std::numeric_limits<double>::infinity();  ///< `steady` of the last refused message
  StampVerdict reason_ = StampVerdict::GOOD;                   ///< of the last refused one
  double offset_ = 0;                                          ///< [s] of the last refused one, stamp - now
  std::array<unsigned long, STAMP_VERDICTS> counts_{};
};

}  // namespace snapwing::common
