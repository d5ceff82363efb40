// The trials with the vectors of AVX-512.
#include <cmath>

#include "ensemble_run.h"

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#pragma GCC target("avx512f,avx512dq,avx512vl")
#endif
#define SNAPWING_WIDTH wide
#define SNAPWING_NATIVE 8
#include "ensemble_kernel.h"

namespace snapwing::rom {
void runBlockWide(const EnsembleScene& scene, const EnsembleBlock& block, EnsembleResult* results) {
  wide::run(scene, block, results);
}
}  // namespace snapwing::rom
