// Cost of a plan for the shipped vehicle on the boom, by threads.
#include <benchmark/benchmark.h>

#include "snapwing/planning/mode_estimator.h"
#include "snapwing/planning/pulse_planner.h"
#include "support/paths.h"

namespace {

using namespace snapwing;

struct Setup {
  vehicle::Vehicle vehicle = vehicle::loadVehicle(snapwing::test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  vehicle::ForceTable table = vehicle::loadForceTable(vehicle.arm.table_file);
};

const Setup& setup() {
  static const Setup instance;
  return instance;
}

void plan(benchmark::State& state, vehicle::Mode start) {
  planning::PlannerSettings settings;
  settings.threads = static_cast<int>(state.range(0));
  vehicle::Trial trial;
  trial.mount = vehicle::Mount::BOOM;
  const planning::PulsePlanner planner(setup().vehicle, setup().table, settings);
  for (auto _ : state) benchmark::DoNotOptimize(planner.plan(start, trial));
}
BENCHMARK_CAPTURE(plan, F_to_Q, vehicle::Mode::FIXED_WING)->Arg(1)->Arg(2)->Unit(benchmark::kSecond)->UseRealTime();
BENCHMARK_CAPTURE(plan, Q_to_F, vehicle::Mode::QUADROTOR)->Arg(1)->Arg(2)->Unit(benchmark::kSecond)->UseRealTime();

void estimatorReading(benchmark::State& state) {
  planning::ModeEstimator estimator(setup().vehicle, setup().table);
  estimator.reset(0.0, vehicle::Mode::FIXED_WING);
  estimator.motorOutput(0.0, 0.5);
  double time = 0;
  for (auto _ : state) estimator.accelerometer(time += 0.005, 4.0);
}
BENCHMARK(estimatorReading)->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
