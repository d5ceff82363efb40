// Cost of one iteration of the arm's design against the degrees of freedom of one equilibrium, by phases.
//   bench_arm_design [planar|volumetric CELL_SIZE_M ITERATIONS]     one row of the table alone, on one thread
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>

#include "snapwing/design/arm/arm_topology.h"
#include "support/paths.h"

namespace {

using namespace snapwing::design;

double cpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double wallSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

using Seconds = ArmTopology::Seconds;

Seconds difference(const Seconds& a, const Seconds& b) {
  return {a.assembly - b.assembly, a.factor - b.factor, a.solve - b.solve, a.derivatives - b.derivatives,
          a.retraces - b.retraces};
}

/// The first iteration, traced from rest, and some warm ones with steps as an optimiser makes them: each variable by up
/// to .05. Shares are of the seconds that the threads spent; derivatives hold a factor, a solve and the rest of theirs.
void measure(bool volumetric, double cell, int threads, int count = 5) {
  ArmDesignSettings s = loadArmDesignSettings(snapwing::test::sourceDir() + "/config/designs/arm_default.yaml");
  s.stages = {{volumetric, cell, 100, 0.05}};
  s.threads = threads;
  ArmTopology problem(s);
  Eigen::VectorXd x = problem.start();
  const double cold = cpuSeconds();
  problem.beginIteration(0, 100);
  if (!problem.evaluate(x, true).valid) {
    std::printf("not evaluated\n");
    return;
  }
  const double cpu = cpuSeconds(), wall = wallSeconds();
  const long before = problem.newtonIterations();
  const Seconds begin = problem.seconds();
  for (int k = 1; k <= count; ++k) {
    for (Eigen::Index j = 0; j < x.size(); ++j)
      x(j) -= 0.025 * (1 + std::sin(0.37 * k + 0.05 * static_cast<double>(j)));
    problem.beginIteration(k, 100);
    if (!problem.evaluate(x.cwiseMax(0.0), true).valid) std::printf("not evaluated\n");
  }
  const double cpu_end = cpuSeconds(), wall_end = wallSeconds();
  const Seconds spent = difference(problem.seconds(), begin);
  const double equilibria = static_cast<double>(s.thresholds.size() * problem.travels().size());
  const double whole = (wall_end - wall) * std::min(threads, static_cast<int>(s.thresholds.size())) / 100;
  std::printf("| %s | %.1f | %d | %d | %d | %d | %.1f | %.2f | %.2f | %.2f | %.0f | %.0f | %.0f | %.0f |\n",
              volumetric ? "volumetric" : "planar", 1e3 * cell, problem.variableCount(), problem.freedomCount(),
              static_cast<int>(equilibria), threads,
              static_cast<double>(problem.newtonIterations() - before) / (count * equilibria), cpu - cold,
              (cpu_end - cpu) / count, (wall_end - wall) / count, spent.assembly / whole, spent.factor / whole,
              spent.solve / whole, spent.derivatives / whole);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 4) {
    measure(argv[1] == std::string("volumetric"), std::atof(argv[2]), 1, std::atoi(argv[3]));
    return 0;
  }
  std::printf(
      "| rung | cell mm | variables | freedoms | equilibria | threads | Newton per equilibrium | CPU s, from rest | "
      "CPU "
      "s, warm | wall s, warm | assembly %% | factors %% | solves %% | derivatives %% |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const double cell : {0.004, 0.002, 0.001}) measure(false, cell, 1);
  for (const double cell : {0.004, 0.002}) measure(true, cell, 1);
  measure(false, 0.001, 2);
  measure(true, 0.002, 2);
}
