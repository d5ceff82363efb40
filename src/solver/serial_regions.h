#pragma once
/// OpenMP regions of other libraries on the calling thread alone, without a call of the kernel.
///
/// CHOLMOD opens a parallel region for every supernode, whatever OMP_NUM_THREADS says; on small supernodes threads cost
/// more than the work (three quarters of a planar factorization). A team of one still ends in a barrier that wakes
/// nobody, by a system call. So this library has an entry point for regions of its own, in front of libgomp's, which
/// runs them as plain calls as long as a SerialRegions lives on the thread. Where it is not in front (a library that is
/// loaded late), regions have a team of one.

namespace snapwing::solver {

class SerialRegions {
 public:
  SerialRegions();
  ~SerialRegions();
  SerialRegions(const SerialRegions&) = delete;
  SerialRegions& operator=(const SerialRegions&) = delete;
  /// Regions that were plain calls, on this thread so far.
  static long called();

 private:
  int levels_;
};

}  // namespace snapwing::solver
