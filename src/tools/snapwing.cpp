// The `snapwing` command line: everything that a node does online can be done here, offline, on the same core.
//
// This program predicts and tells its version. All else it hands to `snapwing_all` beside it: that one is linked with
// solvers, and loading them takes longer than a prediction.
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <string>
#include <system_error>

#include "command_line.h"
#include "commands.h"

namespace {

bool isOwn(int argc, char** argv) {
  const std::string first = argc > 1 ? argv[1] : "";
  return first == "predict" || (first == "--version" && argc == 2);
}

/// Does not come back, unless that fails.
int handOver(char** argv) {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::string program = (self.parent_path() / "snapwing_all").string();
  // BLAS starts a thread for each core as it is loaded, which spins for a while and gets no work (solver::Cholesky).
  setenv("OPENBLAS_NUM_THREADS", "1", 0);
  if (!error) execv(program.c_str(), argv);
  std::cerr << "snapwing: cannot run " << program << ", which holds all commands but predict: "
            << (error ? error.message() : std::string(std::strerror(errno))) << "\n";
  return snapwing::tools::INTERNAL_ERROR;
}

}  // namespace

int main(int argc, char** argv) {
  if (!isOwn(argc, argv)) return handOver(argv);
  return snapwing::tools::runCommandLine(argc, argv, snapwing::tools::addPredictCommand);
}
