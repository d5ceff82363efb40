#include "trial_bag_call.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

#include "snapwing/common/error.h"

extern char** environ;  // NOLINT: POSIX names it so

namespace snapwing::tools {

std::string bagProgram() {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::string path = (self.parent_path() / "trial_bag").string();
  if (error || access(path.c_str(), X_OK) != 0) {
    throw common::Error("--bag: no " + path +
                        ", which writes bags; it is part of a build with ROS (SNAPWING_WITH_ROS=ON)");
  }
  return path;
}

void callBagProgram(const std::string& program, const std::string& folder) {
  std::string name = program, argument = folder;
  char* arguments[] = {name.data(), argument.data(), nullptr};
  pid_t child = 0;
  int status = 0;
  if (posix_spawn(&child, program.c_str(), nullptr, nullptr, arguments, environ) != 0) {
    throw common::Error("--bag: cannot start " + program);
  }
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) throw common::Error("--bag: lost " + program);
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) throw common::Error("--bag: " + program + " wrote no run.bag");
}

}  // namespace snapwing::tools
