// Cost of one iteration of the arm's design, warm, against the degrees of freedom of one equilibrium.
#include <chrono>
#include <cstdio>
#include <ctime>

#include "snapwing/design/arm_topology.h"

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

/// Five iterations with steps as an optimiser makes them: each variable by up to .05.
void measure(bool volumetric, double cell, int threads) {
  ArmDesignSettings s = loadArmDesignSettings(SNAPWING_SOURCE_DIR "/config/designs/arm_default.yaml");
  s.stages = {{volumetric, cell, 100, 0.05}};
  s.threads = threads;
  ArmTopology problem(s);
  Eigen::VectorXd x = problem.start();
  problem.beginIteration(0, 100);
  if (!problem.evaluate(x, true).valid) {
    std::printf("not evaluated\n");
    return;
  }
  constexpr int COUNT = 5;
  const double cpu = cpuSeconds(), wall = wallSeconds();
  const long before = problem.newtonIterations();
  for (int k = 1; k <= COUNT; ++k) {
    for (Eigen::Index j = 0; j < x.size(); ++j)
      x(j) -= 0.025 * (1 + std::sin(0.37 * k + 0.05 * static_cast<double>(j)));
    problem.beginIteration(k, 100);
    problem.evaluate(x.cwiseMax(0.0), true);
  }
  const double equilibria = static_cast<double>(s.thresholds.size() * problem.travels().size());
  std::printf("| %s | %.1f | %d | %ld | %d | %d | %.1f | %.3f | %.3f |\n", volumetric ? "volumetric" : "planar",
              1e3 * cell, problem.variableCount(), static_cast<long>(problem.freedomCount()),
              static_cast<int>(equilibria), threads,
              static_cast<double>(problem.newtonIterations() - before) / (COUNT * equilibria),
              (cpuSeconds() - cpu) / COUNT, (wallSeconds() - wall) / COUNT);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char**) {
  std::printf(
      "| rung | cell mm | variables | freedoms | equilibria | threads | Newton per equilibrium | CPU s | wall s |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
  for (const double cell : {0.004, 0.002, 0.001}) measure(false, cell, 1);
  measure(false, 0.001, 2);
  measure(true, 0.004, 1);
  if (argc > 1) {  // any argument: the long ones, too
    measure(false, 0.0005, 2);
    measure(true, 0.002, 2);
  }
}
