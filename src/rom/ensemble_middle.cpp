// The trials with the vectors of AVX2.
#include <cmath>

#include "ensemble_run.h"

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#pragma GCC target("avx2")
#endif
#define SNAPWING_WIDTH middle
#define SNAPWING_NATIVE 4
#include "ensemble_kernel.h"

namespace snapwing::rom {
void runBlockMiddle(const EnsembleScene& scene, const EnsembleBlock& block, EnsembleResult* results) {
  middle::run(scene, block, results);
}
}  // namespace snapwing::rom
