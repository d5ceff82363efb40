// The optimisers of the wing's design against each other, from the same starts: one row of a Markdown table for each
// rung and optimiser. CPU seconds of this process.
//   bench_wing_optimizers SETTINGS.yaml [STARTS] [RUNG...]     default: the settings' starts, rigid elastic
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include "snapwing/common/error.h"
#include "snapwing/design/wing/wing_outcome.h"

namespace {

using namespace snapwing;
using namespace snapwing::design;

constexpr double FEASIBLE = 1e-6;  ///< of the scaled constraints, as designWing
constexpr double NEAR = 0.01;      ///< of the best objective of all optimisers on a rung

double cpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Runs {
  std::string optimizer;
  std::vector<LocalResult> all;
  double seconds = 0;
  double best() const {
    double least = HUGE_VAL;
    for (const LocalResult& r : all) least = r.violation <= FEASIBLE ? std::min(least, r.objective) : least;
    return least;
  }
};

Runs runAll(WingSettings settings, WingRung rung, const std::string& optimizer) {
  settings.optimizer = optimizer;
  const std::unique_ptr<WingProblem> problem = makeWingProblem(settings, rung);
  const RigidWingProblem rigid(settings);
  const auto starts = sampleLayouts(rigid, settings.samples, settings.starts, static_cast<unsigned>(settings.seed));
  Runs runs{optimizer, {}, 0};
  const double begin = cpuSeconds();
  for (const Eigen::Vector4d& start : starts) runs.all.push_back(improve(*problem, start));
  runs.seconds = cpuSeconds() - begin;
  return runs;
}

void print(WingRung rung, const Runs& runs, double least) {
  int evaluations = 0, most = 0, good = 0;
  for (const LocalResult& r : runs.all) {
    evaluations += r.evaluations;
    most = std::max(most, r.evaluations);
    good += r.violation <= FEASIBLE && r.objective <= (1 + NEAR) * least ? 1 : 0;
  }
  std::printf("| %s | %s | %d | %d | %.3f | %d of %zu | %.2f | %.3f |\n", nameOf(rung), runs.optimizer.c_str(),
              evaluations, most, 1e6 * runs.best(), good, runs.all.size(), runs.seconds,
              1e3 * runs.seconds / evaluations);
  std::fflush(stdout);
}

void compare(const WingSettings& settings, WingRung rung) {
  std::vector<Runs> rows;
  double least = HUGE_VAL;
  for (const char* optimizer : {"nlopt_slsqp", "nlopt_mma", "own_mma"}) {
    rows.push_back(runAll(settings, rung, optimizer));
    least = std::min(least, rows.back().best());
  }
  for (const Runs& runs : rows) print(rung, runs, least);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: bench_wing_optimizers SETTINGS.yaml [STARTS] [RUNG...]\n");
    return 2;
  }
  try {
    WingSettings settings = loadWingSettings(argv[1]);
    if (argc > 2) settings.starts = std::atoi(argv[2]);
    settings.validate();
    std::vector<WingRung> rungs{WingRung::RIGID, WingRung::BEAMS};
    if (argc > 3) rungs.clear();
    for (int k = 3; k < argc; ++k) rungs.push_back(wingRungOf(argv[k]));
    std::printf(
        "| rung | optimiser | evaluations | most in a run | best objective [mm2] | runs within 1 %% | CPU s | "
        "ms an evaluation |\n|---|---|---|---|---|---|---|---|\n");
    for (const WingRung rung : rungs) compare(settings, rung);
  } catch (const common::Error& e) {
    std::fprintf(stderr, "bench_wing_optimizers: %s\n", e.what());
    return 2;
  }
  return 0;
}
