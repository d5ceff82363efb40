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

/// The memory's numbers come last, so that those of the box are what they were without.
void draw(std::mt19937_64& random, TrialFile& out) {
  out.box.resize(vehicle::uncertainNames().size());
  for (double& value : out.box) value = common::uniformAbout0(random);
  out.axis.relaxation_share = common::uniformAbout0(random);
  out.axis.relaxation_time = common::uniformAbout0(random);
}

}  // namespace

void drawVehicle(int seed, TrialFile& out) {
  std::mt19937_64 random(static_cast<std::uint64_t>(seed));
  draw(random, out);
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
  if (file.vary.vehicle) draw(random, out);
  return out;
}

}  // namespace snapwing::motion
