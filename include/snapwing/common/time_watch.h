#pragma once
/// One treatment of time for all who read a clock and stamped messages. Two clocks are told, none is read here:
/// `now`, by which messages are stamped (ROS time: a wall clock that may be set, or a simulated one; 0 = none yet), and
/// `steady`, which only goes on. All times in s.
///
/// | what happens                                   | ClockWatch::look | StampWatch::take |
/// |------------------------------------------------|------------------|------------------|
/// | there is no clock yet                          | MISSING          | NO_CLOCK         |
/// | the clock goes on, or stands                   | ON               |                  |
/// | the clock is set back by more than `tolerance` | BACK             |                  |
/// | it runs ahead of `steady` by more than that    | AHEAD            |                  |
/// | the stamp is 0 or no number                    |                  | UNSTAMPED        |
/// | the stamp lies more than `ahead` after now     |                  | FUTURE           |
/// | the stamp lies more than `stale` before now    |                  | STALE            |
/// | the stamp is that of the last message taken    |                  | REPEATED         |
/// | the stamp lies before that                     |                  | OLDER            |
///
/// After BACK and AHEAD nothing that was known holds any more: restart() every StampWatch and whatever depends on time.

#include <array>
#include <limits>
#include <string>

namespace snapwing::common {

enum class ClockEvent { MISSING, ON, BACK, AHEAD };

/// Sees a clock jump.
class ClockWatch {
 public:
  /// @param tolerance  [s] above 0. @throws Error otherwise
  explicit ClockWatch(double tolerance = 0.5);

  /// To be called often, with both clocks read at the same moment.
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

/// Judges the stamps of one stream of messages. Only GOOD ones are to be used.
class StampWatch {
 public:
  /// @throws Error unless both limits are above 0
  explicit StampWatch(const StampLimits& limits = {});

  StampVerdict take(double stamp, double now, double steady);

  /// [s] since the last good message: by its stamp or since it came, whichever is more, so that a clock that stands
  /// does not keep it young. Infinite if none came.
  double age(double now, double steady) const;
  /// Forgets the last message, not the counts.
  void restart();

  /// Stamp of the last good message; 0 if none came.
  double last() const { return last_; }
  unsigned long count(StampVerdict verdict) const { return counts_[static_cast<std::size_t>(verdict)]; }
  /// What is wrong with the stream, in words: "never came", "stopped 1.2 s ago", "is stamped 3.0 s ahead of the clock".
  /// Empty if the last good message is not older than `oldest` [s].
  std::string trouble(double now, double steady, double oldest) const;

 private:
  StampLimits limits_;
  double last_ = 0;
  double came_ = -std::numeric_limits<double>::infinity();  ///< `steady` of the last good one
  double refused_ = -std::numeric_limits<double>::infinity();
  StampVerdict reason_ = StampVerdict::GOOD;  ///< of the last refused one
  double offset_ = 0;                         ///< [s] its stamp - now
  std::array<unsigned long, STAMP_VERDICTS> counts_{};
};

}  // namespace snapwing::common
