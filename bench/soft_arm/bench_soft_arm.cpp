// The lumped model against one soft arm integrated in time (soft_arm.h), on the boom, nominal vehicle, wings off: the
// shortest pulses that switch, and the trials just above them. Prints the table of docs/reduced_model.md.
// usage: bench_soft_arm [cell size in mm [time step in ms]]
#include <cstdio>
#include <cstdlib>

#include "support/paths.h"
#include "trials.h"

using namespace snapwing;
using bench::Outcome;
using vehicle::Mode;

namespace {

struct Case {
  Mode start;
  double fraction;
};

rom::LumpedModel lumped(const bench::ArmBody& body, bool weightless) {
  vehicle::ForceTable table = body.table;
  if (weightless) {
    table.mass = 0;
    table.kinetic_mass.assign(table.travel.size(), 0.0);
    table.coupled_mass = table.kinetic_mass;
  }
  return rom::LumpedModel::fromVehicle(body.vehicle, table, body.parameters);
}

double lumpedThreshold(const rom::LumpedModel& model, const Case& c) {
  // The shortest pulse of all that switch.
  double low = 0;
  for (double high = 0.005; high < 1.5; low = high, high += 0.005) {
    if (bench::lumpedTrial(model, c.start, c.fraction, high).end == c.start) continue;
    for (int i = 0; i < 20; ++i) {
      const double middle = 0.5 * (low + high);
      (bench::lumpedTrial(model, c.start, c.fraction, middle).end == c.start ? low : high) = middle;
    }
    return high;
  }
  return NAN;
}

}  // namespace

int main(int argc, char** argv) {
  const double cell = argc > 1 ? 1e-3 * std::atof(argv[1]) : 0.0, dt = argc > 2 ? 1e-3 * std::atof(argv[2]) : 1e-3;
  const vehicle::Vehicle vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  const bench::ArmBody body(vehicle, cell, 0.2, 0.001);
  const rom::LumpedModel with = lumped(body, false), without = lumped(body, true);
  std::printf(
      "start,thrust_fraction,threshold_without_arms_ms,threshold_lumped_ms,threshold_soft_arm_ms,"
      "pulse_ms,snap_lumped_ms,snap_soft_ms,peak_lumped_mm,peak_soft_mm\n");
  for (const Case& c : {Case{Mode::FIXED_WING, 0.5}, {Mode::QUADROTOR, 1.0}}) {
    const double bare = lumpedThreshold(without, c), expected = lumpedThreshold(with, c);
    std::fprintf(stderr, "%s: lumped %.2f ms, without the arms' mass %.2f ms\n", c.start == Mode::QUADROTOR ? "Q" : "F",
                 1e3 * expected, 1e3 * bare);
    const auto soft = [&](double duration) { return bench::softTrial(body, c.start, c.fraction, duration, dt); };
    const double found = bench::threshold(expected - 0.004, expected + 0.004, 5, soft, c.start);
    const double pulse = expected + 0.02;
    const Outcome a = bench::lumpedTrial(with, c.start, c.fraction, pulse), b = soft(pulse);
    std::printf("%s,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,%.3f,%.3f\n", c.start == Mode::QUADROTOR ? "Q" : "F", c.fraction,
                1e3 * bare, 1e3 * expected, 1e3 * found, 1e3 * pulse, 1e3 * a.snap_time, 1e3 * b.snap_time,
                1e3 * a.peak, 1e3 * b.peak);
    std::fflush(stdout);
  }
  return 0;
}
