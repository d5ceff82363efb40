// Cost of one Newton iteration of a scene by phases: tangent, factorization, solve. CPU seconds of one thread, the
// least of several repeats, as one line of JSON for each cell size. bench/speed makes a table and a picture of it.
//   bench_statics SCENE.yaml KERNEL PARTICLES CELL_SIZE_M...
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <string>

#include "snapwing/common/error.h"
#include "snapwing/scene/scene_problem.h"

namespace {

using namespace snapwing;

double cpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double least(int repeats, const std::function<void()>& work) {
  double best = 1e300;
  for (int k = 0; k < repeats; ++k) {
    const double begin = cpuSeconds();
    work();
    best = std::min(best, cpuSeconds() - begin);
  }
  return best;
}

void measure(scene::Scene scene, double cell_size) {
  scene.cell_size = cell_size;
  std::unique_ptr<scene::CompiledScene> compiled;
  const double compile = least(1, [&] { compiled = scene::compileScene(scene, 1); });
  const solver::Problem& problem = compiled->problem();
  solver::Evaluation at;
  const Eigen::VectorXd z = Eigen::VectorXd::Zero(problem.freeCount()), p = Eigen::VectorXd::Constant(1, 1e-6);
  const int repeats = problem.freeCount() > 50000 ? 3 : 7;
  problem.evaluate(z, p, solver::Order::TANGENT, at);
  const double tangent = least(repeats, [&] { problem.evaluate(z, p, solver::Order::TANGENT, at); });
  std::unique_ptr<solver::Cholesky> cholesky;
  const double analysis = least(1, [&] { cholesky = std::make_unique<solver::Cholesky>(problem.pattern()); });
  bool good = true;
  const double factor = least(repeats, [&] { good = cholesky->factorize(at.hessian) && good; });
  if (!good) throw common::Error("the Hessian has no Cholesky factor");
  Eigen::VectorXd x;
  const double solve = least(repeats, [&] { x = cholesky->solve(at.residual); });
  std::printf(
      "{\"cell_m\": %g, \"cells\": %d, \"dof\": %d, \"factor_entries\": %.0f, \"compile\": %g, \"analysis\": %g, "
      "\"assembly\": %g, \"factorization\": %g, \"solve\": %g}\n",
      cell_size, compiled->cellCount(), problem.freeCount(), cholesky->factorEntries(), compile, analysis, tangent,
      factor, solve);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 5) {
    std::fprintf(stderr, "usage: bench_statics SCENE.yaml linear|linear_reduced|quadratic PARTICLES CELL_SIZE_M...\n");
    return 2;
  }
  try {
    scene::Scene scene = scene::loadScene(argv[1]);
    const std::string kernel = argv[2];
    scene.kernel = kernel == "quadratic"        ? scene::SceneKernel::QUADRATIC
                   : kernel == "linear_reduced" ? scene::SceneKernel::LINEAR_REDUCED
                                                : scene::SceneKernel::LINEAR;
    scene.particles = std::atoi(argv[3]);
    for (int k = 4; k < argc; ++k) measure(scene, std::atof(argv[k]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_statics: %s\n", error.what());
    return 2;
  }
  return 0;
}
