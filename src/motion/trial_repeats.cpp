#include <algorithm>
#include <random>

#include "snapwing/common/error.h"
#include "snapwing/common/uniform.h"
#include "snapwing/motion/trial_file.h"
#include "snapwing/vehicle/vehicle_parameters.h"

namespace snapwing::motion {

namespace {

void varyLevel(TrialLevel& level, const TrialVariation& by, std::mt19937_64& random) {
  double& strength = level.throttle < 0 ? level.thrust : level.throttle;
  strength = std::clamp(strength * (1 + by.strength * common::uniformAbout0(random)), 0.0, 1.0);
  level.duration = std::max(0.0, level.duration + by.duration * common::uniformAbout0(random));
}

std::vector<double> drawBox(std::mt19937_64& random) {
  std::vector<double> box(vehicle::uncertainNames().size());
  for (double& value : box) value = common::uniformAbout0(random);
  return box;
}

}  // namespace

std::vector<double> drawnBox(int seed) {
  std::mt19937_64 random(static_cast<std::uint64_t>(seed));
  return drawBox(random);
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
  if (file.vary.vehicle) out.box = drawBox(random);
  return out;
}

}  // namespace snapwing::motion
