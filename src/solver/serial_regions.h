#pragma once
/// Runs OpenMP parallel regions of other libraries serially on the calling thread, without system calls.
///
/// CHOLMOD opens a parallel region for every supernode, whatever OMP_NUM_THREADS says. On small supernodes the threads
/// cost more than the work (three quarters of a planar factorisation). A team of one thread still ends in a barrier
/// with a system call. Therefore this library defines its own GOMP_parallel, ahead of libgomp's, which runs regions as
/// plain calls while a SerialRegions lives on the thread. If another definition comes first (a library loaded late),
/// regions have a team of one thread.

namespace snapwing::solver {

class SerialRegions {
 public:
  SerialRegions();
  ~SerialRegions();
  SerialRegions(const SerialRegions&) = delete;
  SerialRegions& operator=(const SerialRegions&) = delete;
  /// Number of regions run as plain calls on this thread so far.
  static long called();

 private:
  int levels_;
};

}  // namespace snapwing::solver
