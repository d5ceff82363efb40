#pragma once
/// The force that somebody may put on the ring side, as one particle believes it: a jump Markov process [Doucet,
/// Gordon and Krishnamurthy 2001].
///   nobody touches -> touch   with the rate lambda: strength s = S sqrt(e), e exponential with mean 1, force s N(0, 1)
///   touch -> nobody           with the rate 1 / T
///   while it lasts            df = -f / T dt + s sqrt(2 / T) dW       (Ornstein and Uhlenbeck, exact over a step)
/// A normal force with an exponential variance is Laplace distributed, here with the standard deviation S: light
/// touches are common, and a shove of several S is not ruled out. Touches are proposed more often than they occur, and
/// weighed down for it.

#include "random_source.h"

namespace snapwing::planning {

/// Of one particle.
struct OutsideForce {
  double strength = 0;  ///< s [N], 0 = nobody touches
  double force = 0;     ///< [N] along the thrust axis
  bool touched() const { return strength > 0; }
};

class OutsideForceProcess {
 public:
  /// @param strength  S [N], 0 = never; @param rate  lambda [1/s]; @param time  T [s]
  OutsideForceProcess(double strength, double rate, double time) : strength_(strength), rate_(rate), time_(time) {}

  bool acts() const { return strength_ > 0 && rate_ > 0; }

  /// Moves a force on. @return factor on the particle's weight: probability of what happened / of its being proposed
  double move(OutsideForce* outside, double span, RandomSource& random) const;

 private:
  double strength_, rate_, time_;
};

}  // namespace snapwing::planning
