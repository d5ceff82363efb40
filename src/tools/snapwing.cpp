// The `snapwing` command line: everything that a node does online can be done here, offline, on the same core.
//
// This program tells its version. It predicts by a module beside it, since loading HDF5 and what that is linked with
// takes most of a start. All else it hands to `snapwing_all`: that one is linked with solvers, and loading them takes
// longer than a prediction.
#include <dlfcn.h>
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

std::filesystem::path beside(const char* name, std::error_code& error) {
  return std::filesystem::read_symlink("/proc/self/exe", error).parent_path() / name;
}

int tellVersion() {
  snapwing::tools::keepFailedWrites();
  std::cout << SNAPWING_VERSION << "\n";
  return snapwing::tools::afterPrinting(0);
}

/// The module's entry; null if it cannot be loaded.
int (*predictCommand())(int, char**) {
  std::error_code error;
  const std::string module = beside("libsnapwing_predict.so", error).string();
  void* loaded = error ? nullptr : dlopen(module.c_str(), RTLD_LAZY);
  return loaded == nullptr ? nullptr : reinterpret_cast<int (*)(int, char**)>(dlsym(loaded, "snapwingPredict"));
}

/// Does not come back, unless that fails.
int handOver(char** argv) {
  std::error_code error;
  const std::string program = beside("snapwing_all", error).string();
  // BLAS starts a thread for each core as it is loaded, which spins for a while and gets no work (solver::Cholesky).
  setenv("OPENBLAS_NUM_THREADS", "1", 0);
  if (!error) execv(program.c_str(), argv);
  std::cerr << "snapwing: cannot run " << program
            << ", which holds all commands: " << (error ? error.message() : std::string(std::strerror(errno))) << "\n";
  return snapwing::tools::INTERNAL_ERROR;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string first = argc > 1 ? argv[1] : "";
  if (first == "--version" && argc == 2) return tellVersion();
  if (first == "predict") {
    if (const auto predict = predictCommand()) return predict(argc, argv);
  }
  return handOver(argv);
}
