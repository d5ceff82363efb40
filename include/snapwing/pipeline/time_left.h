#pragma once
/// How long work will still take, from the share of it that is done. It reads no clock.

namespace snapwing::pipeline {

class TimeLeft {
 public:
  /// Call at each progress of the work; a share below the last one restarts the estimate.
  /// @param share  done, 0 .. 1; NaN = not known. @param now  [s] of a monotonic clock
  /// @return [s]; NaN as long as nothing is known. What was done at once, as kept results, does not count
  double after(double share, double now);

 private:
  double share_ = -1, last_ = 0;  ///< of the last call
  double first_share_ = 0, first_ = 0;
};

}  // namespace snapwing::pipeline
