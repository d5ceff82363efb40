#pragma once
/// Motion along the thrust axis of a hand that holds the ring: a harmonic swing and band-limited noise. A function of
/// time, so that a trial can be repeated and resumed.

#include <cstdint>
#include <vector>

namespace snapwing::motion {

struct HandSettings {
  double noise = 0;            ///< [m/s2] root mean square of the acceleration
  double low = 1, high = 12;   ///< [Hz] band of the noise, 0 < low < high: voluntary motion up to tremor
  std::uint64_t seed = 0;      ///< of the noise
  double swing = 0;            ///< [m] amplitude of a harmonic motion
  double swing_frequency = 1;  ///< [Hz] > 0
  /// @throws common::Error naming the member
  void validate() const;
};

/// Sum of waves: the swing, and 64 of equal acceleration amplitude in the band.
class HandMotion {
 public:
  /// @throws common::Error (HandSettings::validate)
  explicit HandMotion(const HandSettings& settings);
  double position(double time) const;      ///< relative to time 0 [m]
  double speed(double time) const;         ///< [m/s]
  double acceleration(double time) const;  ///< [m/s2]
  /// Exact mean of the acceleration over `from` .. `from + h` [s]. [m/s2]
  double meanAcceleration(double from, double h) const { return (speed(from + h) - speed(from)) / h; }

 private:
  struct Wave {
    double amplitude, rate, phase;  // of the position [m], [rad/s]
  };
  std::vector<Wave> waves_;
};

}  // namespace snapwing::motion
