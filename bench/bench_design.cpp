// Cost of the wing's rungs: one position, one position with derivatives, one elastic equilibrium, whole designs.
#include <benchmark/benchmark.h>

#include "snapwing/design/wing/wing_design.h"
#include "snapwing/design/wing/wing_elastic_problem.h"
#include "support/paths.h"

namespace {

using namespace snapwing::design;

const WingSettings& settings() {
  static const WingSettings instance =
      loadWingSettings(snapwing::test::sourceDir() + "/config/designs/wing_paper.yaml");
  return instance;
}

const FourBar& linkage() {
  static const FourBar instance = designWing(RigidWingProblem(settings())).linkage;
  return instance;
}

void rigidPose(benchmark::State& state) {
  double theta = 0.0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(poseAt(linkage(), theta));
    theta = theta < 0.9 ? theta + 1e-3 : 0.0;
  }
}
BENCHMARK(rigidPose);

void rigidPoseWithDerivatives(benchmark::State& state) {
  double theta = 0.0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(sensitivityAt(linkage(), theta));
    theta = theta < 0.9 ? theta + 1e-3 : 0.0;
  }
}
BENCHMARK(rigidPoseWithDerivatives);

void travelCheck(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(checkTravel(linkage(), 0.93));
}
BENCHMARK(travelCheck);

void elasticEquilibrium(benchmark::State& state) {
  const ElasticLinkage elastic(linkage(), settings().bars);
  for (auto _ : state) benchmark::DoNotOptimize(elastic.solve(0.83));
}
BENCHMARK(elasticEquilibrium)->Unit(benchmark::kMillisecond);

void rigidDesign(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(designWing(RigidWingProblem(settings())));
}
BENCHMARK(rigidDesign)->Unit(benchmark::kMillisecond);

void elasticDesign(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(designWing(ElasticWingProblem(settings())));
}
BENCHMARK(elasticDesign)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace

BENCHMARK_MAIN();
