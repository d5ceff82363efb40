#pragma once
/// How long work will still take, from the share of it that is done. It reads no clock.

namespace snapwing::pipeline {

class TimeLeft {
 public:
  /// To be told each time that work goes on; a share below the last one begins anew.
  /// @param share  done, 0 .. 1; NaN = not known. @param now  [s] of a clock that only goes on
  /// @return [s]; NaN as long as nothing is known. What was done at once, as results that were kept, tells nothing
  double after(double share, double now);

 private:
  double share_ = -1, last_ = 0;  ///< of the last call
  double first_share_ = 0, first_ = 0;
};

}  // namespace snapwing::pipeline
