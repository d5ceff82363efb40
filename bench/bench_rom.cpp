// Cost of the reduced model: one step (goal: below 5 us) and one predicted pulse.
#include <benchmark/benchmark.h>

#include "snapwing/rom/lumped_model.h"
#include "snapwing/vehicle/table_origin.h"
#include "snapwing/vehicle/vehicle.h"
#include "support/paths.h"

namespace {

using namespace snapwing;

struct Setup {
  vehicle::Vehicle vehicle = vehicle::loadVehicle(snapwing::test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  vehicle::ForceTable table = vehicle::loadForceTable(vehicle.arm.table_file);
  rom::LumpedModel model = rom::LumpedModel::fromVehicle(vehicle, table, vehicle::realise(vehicle, table), {},
                                                         vehicle::wingTableOf(vehicle, table));
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

vehicle::Trial trialOn(vehicle::Mount mount) {  // wings act in flight, not on the boom
  vehicle::Trial trial;
  trial.mount = mount;
  return trial;
}

void oneStep(benchmark::State& state, vehicle::Mount mount) {
  const rom::LumpedModel& model = setup().model;
  const vehicle::Trial trial = trialOn(mount);
  const rom::LumpedState start = model.startState(vehicle::Mode::FIXED_WING, trial);
  rom::LumpedState now = start;
  for (auto _ : state) {
    now = model.step(now, 0.5, 5e-4, trial);
    if (now.time > 1.0) now = start;
    benchmark::DoNotOptimize(now);
  }
}
BENCHMARK_CAPTURE(oneStep, boom, vehicle::Mount::BOOM);
BENCHMARK_CAPTURE(oneStep, free_with_wings, vehicle::Mount::FREE);

void wholePulse(benchmark::State& state, vehicle::Mount mount, vehicle::Mode start, vehicle::Pulse pulse) {
  const vehicle::Trial trial = trialOn(mount);
  long steps = 0;
  for (auto _ : state) {
    const rom::SnapPrediction p = setup().model.predict(start, pulse, setup().vehicle.radio, trial);
    steps += p.steps;
    benchmark::DoNotOptimize(p);
  }
  state.counters["step_s"] =
      benchmark::Counter(static_cast<double>(steps), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK_CAPTURE(wholePulse, boom_F_to_Q, vehicle::Mount::BOOM, vehicle::Mode::FIXED_WING,
                  vehicle::Pulse{0.685, 0.163});
BENCHMARK_CAPTURE(wholePulse, boom_Q_to_F, vehicle::Mount::BOOM, vehicle::Mode::QUADROTOR, vehicle::Pulse{1.0, 0.921});
BENCHMARK_CAPTURE(wholePulse, winged_F_to_Q, vehicle::Mount::FREE, vehicle::Mode::FIXED_WING,
                  vehicle::Pulse{0.677, 0.211});
BENCHMARK_CAPTURE(wholePulse, winged_Q_to_F, vehicle::Mount::FREE, vehicle::Mode::QUADROTOR,
                  vehicle::Pulse{1.0, 0.951});

}  // namespace

BENCHMARK_MAIN();
