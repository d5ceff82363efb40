#pragma once
/// How a hand that holds the ring moves along the thrust axis: a swing, and noise between two frequencies. Known for
/// all times, so that a trial can be repeated and resumed.

#include <cstdint>
#include <vector>

namespace snapwing::motion {

struct HandSettings {
  double noise = 0;            ///< [m/s2] root mean square of the acceleration
  double low = 1, high = 12;   ///< [Hz] band of the noise: what an arm means to do, up to its tremor
  std::uint64_t seed = 0;      ///< of the noise
  double swing = 0;            ///< [m] amplitude of a harmonic motion
  double swing_frequency = 1;  ///< [Hz] > 0
  /// @throws common::Error naming the member
  void validate() const;
};

class HandMotion {
 public:
  explicit HandMotion(const HandSettings& settings);
  double position(double time) const;      ///< from that at time 0 [m]
  double speed(double time) const;         ///< [m/s]
  double acceleration(double time) const;  ///< [m/s2]
  /// Mean of the acceleration, exact.
  double meanAcceleration(double from, double h) const { return (speed(from + h) - speed(from)) / h; }

 private:
  struct Wave {
    double amplitude, rate, phase;  // of the position [m], [rad/s]
  };
  std::vector<Wave> waves_;
};

}  // namespace snapwing::motion
