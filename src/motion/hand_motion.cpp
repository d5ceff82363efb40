#include "snapwing/motion/hand_motion.h"

#include <cmath>
#include <random>

#include "snapwing/common/require.h"
#include "snapwing/common/uniform.h"

namespace snapwing::motion {

void HandSettings::validate() const {
  const common::Require require("hand");
  require.notNegative("noise", noise, " m/s2");
  require.notNegative("swing", swing, " m");
  require.positive("low", low, " Hz");
  require(high > low && std::isfinite(high), "high", high, "above low, in Hz");
  require.positive("swing_frequency", swing_frequency, " Hz");
}

/// The noise is a sum of waves of equal acceleration, one in each of equal parts of the band.
HandMotion::HandMotion(const HandSettings& settings) {
  constexpr int WAVES = 64;
  settings.validate();
  const double pi = std::acos(-1.0);
  if (settings.swing > 0) waves_.push_back({settings.swing, 2 * pi * settings.swing_frequency, 0});
  if (!(settings.noise > 0)) return;
  std::mt19937_64 random(settings.seed);
  for (int k = 0; k < WAVES; ++k) {
    const double rate =
        2 * pi * (settings.low + (settings.high - settings.low) * (k + common::uniform(random)) / WAVES);
    waves_.push_back({settings.noise * std::sqrt(2.0 / WAVES) / (rate * rate), rate, 2 * pi * common::uniform(random)});
  }
}

double HandMotion::position(double time) const {
  double sum = 0;
  for (const Wave& w : waves_) sum += w.amplitude * (std::sin(w.rate * time + w.phase) - std::sin(w.phase));
  return sum;
}

double HandMotion::speed(double time) const {
  double sum = 0;
  for (const Wave& w : waves_) sum += w.amplitude * w.rate * std::cos(w.rate * time + w.phase);
  return sum;
}

double HandMotion::acceleration(double time) const {
  double sum = 0;
  for (const Wave& w : waves_) sum -= w.amplitude * w.rate * w.rate * std::sin(w.rate * time + w.phase);
  return sum;
}

}  // namespace snapwing::motion
