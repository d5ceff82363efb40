// Cost of the reduced model: one step (goal: below 5 us) and one predicted pulse.
#include <benchmark/benchmark.h>

#include "snapwing/common/vehicle.h"
#include "snapwing/rom/lumped_model.h"

namespace {

using namespace snapwing;

struct Setup {
  common::Vehicle vehicle = common::loadVehicle(SNAPWING_SOURCE_DIR "/config/vehicles/arris_x220.yaml");
  common::ForceTable table = common::loadForceTable(vehicle.arm.table_file);
  rom::LumpedModel model = rom::LumpedModel::fromVehicle(vehicle, table, common::realise(vehicle, table));
};

const Setup& setup() {
  static const Setup instance;
  return instance;
}

void energyAndForce(benchmark::State& state) {
  const rom::Potential& potential = setup().model.potential();
  double u = 0.01;
  for (auto _ : state) {
    benchmark::DoNotOptimize(potential.at(u));
    u = u < 0.07 ? u + 1e-5 : 0.01;
  }
}
BENCHMARK(energyAndForce);

void oneStep(benchmark::State& state) {
  const rom::LumpedModel& model = setup().model;
  rom::Trial trial;
  trial.mount = rom::Mount::BOOM;
  const rom::LumpedState start = model.startState(common::Mode::FIXED_WING, trial);
  rom::LumpedState now = start;
  for (auto _ : state) {
    now = model.step(now, 0.5, 5e-4, trial);
    if (now.time > 1.0) now = start;
    benchmark::DoNotOptimize(now);
  }
}
BENCHMARK(oneStep);

void wholePulse(benchmark::State& state, common::Mode start, common::Pulse pulse) {
  rom::Trial trial;
  trial.mount = rom::Mount::BOOM;
  long steps = 0;
  for (auto _ : state) {
    const rom::SnapPrediction p = setup().model.predict(start, pulse, setup().vehicle.radio, trial);
    steps += p.steps;
    benchmark::DoNotOptimize(p);
  }
  state.counters["step_s"] =
      benchmark::Counter(static_cast<double>(steps), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK_CAPTURE(wholePulse, F_to_Q, common::Mode::FIXED_WING, common::Pulse{0.685, 0.163});
BENCHMARK_CAPTURE(wholePulse, Q_to_F, common::Mode::QUADROTOR, common::Pulse{1.0, 0.921});

}  // namespace

BENCHMARK_MAIN();
