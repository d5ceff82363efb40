#include "serial_regions.h"

#include <dlfcn.h>
#include <omp.h>

namespace snapwing::solver {

namespace {
thread_local int alive = 0;
thread_local long plain_calls = 0;
}  // namespace

SerialRegions::SerialRegions() : levels_(omp_get_max_active_levels()) {
  omp_set_max_active_levels(0);
  ++alive;
}

SerialRegions::~SerialRegions() {
  --alive;
  omp_set_max_active_levels(levels_);
}

long SerialRegions::called() { return plain_calls; }

}  // namespace snapwing::solver

/// What compilers make of `#pragma omp parallel`. Within a region of somebody else's the number of the thread is that
/// one's, so that it goes libgomp's way.
extern "C" void GOMP_parallel(void (*body)(void*), void* data, unsigned threads, unsigned flags) {  // NOLINT: its name
  using Region = void (*)(void (*)(void*), void*, unsigned, unsigned);
  static const auto next = reinterpret_cast<Region>(dlsym(RTLD_NEXT, "GOMP_parallel"));
  if (next == nullptr || (snapwing::solver::alive > 0 && omp_get_level() == 0)) {
    ++snapwing::solver::plain_calls;
    body(data);
  } else {
    next(body, data, threads, flags);
  }
}
