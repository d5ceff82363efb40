#include <algorithm>
#include <random>

#include "snapwing/common/error.h"
#include "snapwing/motion/trial_file.h"
#include "snapwing/vehicle/vehicle_parameters.h"

namespace snapwing::motion {

namespace {

/// Uniform in [-1, 1], the same on every machine.
double drawn(std::mt19937_64& random) { return 2.0 * static_cast<double>(random() >> 11) / 9007199254740992.0 - 1.0; }

void varyLevel(TrialLevel& level, const TrialVariation& by, std::mt19937_64& random) {
  double& strength = level.throttle < 0 ? level.thrust : level.throttle;
  strength = std::clamp(strength * (1 + by.strength * drawn(random)), 0.0, 1.0);
  level.duration = std::max(0.0, level.duration + by.duration * drawn(random));
}

}  // namespace

std::vector<double> drawnBox(int seed) {
  std::mt19937_64 random(static_cast<std::uint64_t>(seed));
  std::vector<double> box(vehicle::uncertainNames().size());
  for (double& value : box) value = drawn(random);
  return box;
}

TrialFile repeatOf(const TrialFile& file, int index) {
  if (index < 0 || index >= file.repeats) {
    throw common::Error("trial repeat: " + std::to_string(index) + "; allowed: 0 .. " +
                        std::to_string(file.repeats - 1));
  }
  TrialFile out = file;
  if (file.repeats == 1) return out;
  out.repeats = 1;
  out.name += "_" + std::to_string(index + 1);
  // Of seed and index alone: more repeats leave the first ones as they were.
  std::seed_seq seeds{file.vary.seed, index};
  std::mt19937_64 random(seeds);
  varyLevel(out.pulse, file.vary, random);
  for (TrialLevel& level : out.then) varyLevel(level, file.vary, random);
  if (file.vary.vehicle) {
    out.box.resize(vehicle::uncertainNames().size());
    for (double& value : out.box) value = drawn(random);
  }
  return out;
}

}  // namespace snapwing::motion
