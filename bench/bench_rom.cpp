// Cost of the reduced model: one step (goal: below 5 us) and one predicted pulse.
#include <benchmark/benchmark.h>

#include "snapwing/common/table_origin.h"
#include "snapwing/common/vehicle.h"
#include "snapwing/rom/lumped_model.h"
#include "support/paths.h"

namespace {

using namespace snapwing;

struct Setup {
  common::Vehicle vehicle = common::loadVehicle(snapwing::test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  common::ForceTable table = common::loadForceTable(vehicle.arm.table_file);
  rom::LumpedModel model = rom::LumpedModel::fromVehicle(vehicle, table, common::realise(vehicle, table), {},
                                                         common::wingTableOf(vehicle, table));
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

rom::Trial trialOn(rom::Mount mount) {  // wings act in flight, not on the boom
  rom::Trial trial;
  trial.mount = mount;
  return trial;
}

void oneStep(benchmark::State& state, rom::Mount mount) {
  const rom::LumpedModel& model = setup().model;
  const rom::Trial trial = trialOn(mount);
  const rom::LumpedState start = model.startState(common::Mode::FIXED_WING, trial);
  rom::LumpedState now = start;
  for (auto _ : state) {
    now = model.step(now, 0.5, 5e-4, trial);
    if (now.time > 1.0) now = start;
    benchmark::DoNotOptimize(now);
  }
}
BENCHMARK_CAPTURE(oneStep, boom, rom::Mount::BOOM);
BENCHMARK_CAPTURE(oneStep, free_with_wings, rom::Mount::FREE);

void wholePulse(benchmark::State& state, rom::Mount mount, common::Mode start, common::Pulse pulse) {
  const rom::Trial trial = trialOn(mount);
  long steps = 0;
  for (auto _ : state) {
    const rom::SnapPrediction p = setup().model.predict(start, pulse, setup().vehicle.radio, trial);
    steps += p.steps;
    benchmark::DoNotOptimize(p);
  }
  state.counters["step_s"] =
      benchmark::Counter(static_cast<double>(steps), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK_CAPTURE(wholePulse, boom_F_to_Q, rom::Mount::BOOM, common::Mode::FIXED_WING, common::Pulse{0.685, 0.163});
BENCHMARK_CAPTURE(wholePulse, boom_Q_to_F, rom::Mount::BOOM, common::Mode::QUADROTOR, common::Pulse{1.0, 0.921});
BENCHMARK_CAPTURE(wholePulse, winged_F_to_Q, rom::Mount::FREE, common::Mode::FIXED_WING, common::Pulse{0.677, 0.211});
BENCHMARK_CAPTURE(wholePulse, winged_Q_to_F, rom::Mount::FREE, common::Mode::QUADROTOR, common::Pulse{1.0, 0.951});

}  // namespace

BENCHMARK_MAIN();
