// The `snapwing` command line: everything that a node does online can be done here, offline, on the same core.
//
// This program tells its version. It hands predictions and plans to `snapwing_predict` and all else to `snapwing_all`:
// that one is linked with solvers, and loading them takes longer than a prediction.
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <string>
#include <system_error>

#include "command_line.h"
#include "standard_output.h"

namespace {

int tellVersion() {
  snapwing::tools::keepFailedWrites();
  std::cout << SNAPWING_VERSION << "\n";
  return snapwing::tools::afterPrinting(0);
}

/// Becomes another program, with the same arguments. Comes back only if that fails: the reason.
std::string become(const std::filesystem::path& program, char** argv) {
  execv(program.c_str(), argv);
  return std::strerror(errno);
}

/// Does not come back, unless that fails.
int handOver(bool online, char** argv) {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  if (online && !error) become(folder / "snapwing_predict", argv);  // where it is missing, the next one serves
  const std::filesystem::path program = folder / "snapwing_all";
  // BLAS starts a thread for each core as it is loaded, which spins for a while and gets no work (solver::Cholesky).
  setenv("OPENBLAS_NUM_THREADS", "1", 0);
  const std::string why = error ? error.message() : become(program, argv);
  std::cerr << "snapwing: cannot run " << program.string() << ", which holds all commands: " << why << "\n";
  return snapwing::tools::INTERNAL_ERROR;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string first = argc > 1 ? argv[1] : "";
  if (first == "--version" && argc == 2) return tellVersion();
  return handOver(first == "predict" || first == "plan", argv);
}
