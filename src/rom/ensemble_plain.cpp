// The trials with vectors that every processor has.
#include <cmath>

#include "ensemble_run.h"

#define SNAPWING_WIDTH plain
#define SNAPWING_NATIVE 2
#include "ensemble_kernel.h"

namespace snapwing::rom {

void runBlockPlain(const EnsembleScene& scene, const EnsembleBlock& block, EnsembleResult* results) {
  plain::run(scene, block, results);
}

RunBlock widestRunBlock() {
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl")) {
    return runBlockWide;
  }
  if (__builtin_cpu_supports("avx2")) return runBlockMiddle;
#endif
  return runBlockPlain;
}

}  // namespace snapwing::rom
