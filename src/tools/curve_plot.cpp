// `snapwing curve --plot`: hands the curve to scripts/plot_curve (matplotlib).
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "curve_options.h"
#include "snapwing/common/error.h"
#include "snapwing/common/json_text.h"
#include "snapwing/common/provenance.h"

extern char** environ;

namespace snapwing::tools {

namespace {

/// Beside the program if installed, else in `scripts` of a folder above (a build tree in its source).
std::string plotProgram() {
  std::error_code none;
  std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe", none).parent_path();
  if (std::filesystem::exists(folder / "plot_curve")) return (folder / "plot_curve").string();
  for (int level = 0; level < 8 && folder.has_relative_path(); ++level, folder = folder.parent_path()) {
    if (std::filesystem::exists(folder / "scripts" / "plot_curve")) return (folder / "scripts" / "plot_curve").string();
  }
  throw common::Error(
      "--plot needs the script plot_curve, which is neither beside this program nor in a scripts folder above");
}

/// One end of a pipe that closes itself.
struct PipeEnd {
  int fd = -1;
  ~PipeEnd() { close(); }
  void close() {
    if (fd >= 0) ::close(fd);
    fd = -1;
  }
};

bool openPipe(PipeEnd& out, PipeEnd& in) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return false;
  out.fd = ends[0], in.fd = ends[1];
  return true;
}

/// Runs a program that reads all of its input before it writes. @return exit code, -1 if it did not run or was killed
int run(std::vector<std::string> words, const std::string& input, std::string& output) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  PipeEnd child_in, to_child, from_child, child_out;
  if (!openPipe(child_in, to_child) || !openPipe(from_child, child_out)) return -1;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, child_in.fd, 0);
  posix_spawn_file_actions_adddup2(&actions, child_out.fd, 1);
  pid_t child = 0;
  const bool started = posix_spawn(&child, arguments[0], &actions, nullptr, arguments.data(), environ) == 0;
  posix_spawn_file_actions_destroy(&actions);
  child_in.close(), child_out.close();
  if (!started) return -1;
  for (std::size_t done = 0; done < input.size();) {
    const ssize_t n = ::write(to_child.fd, input.data() + done, input.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;  // it went away: its exit code says so
    done += static_cast<std::size_t>(n);
  }
  to_child.close();
  char block[65536];
  for (;;) {
    const ssize_t n = ::read(from_child.fd, block, sizeof block);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    output.append(block, static_cast<std::size_t>(n));
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::string formatOf(const std::string& picture) {
  for (const char* format : {"png", "pdf", "svg"}) {
    if (endsWith(picture, std::string(".") + format)) return format;
  }
  throw common::Error("--plot is '" + picture + "'; allowed: a name ending in .png, .pdf or .svg");
}

}  // namespace

void requirePlotting(const std::string& picture) {
  formatOf(picture);
  std::string nothing;
  if (run({plotProgram(), "--check"}, "", nothing) != 0)
    throw common::Error("--plot needs Python 3 with matplotlib (Debian: python3-matplotlib)");
}

void plotCurve(const std::string& csv, const std::string& summary, const std::string& picture) {
  const nlohmann::json input = {{"csv", common::shownBytes(csv)}, {"summary", nlohmann::json::parse(summary)}};
  std::string bytes;
  const int code = run({plotProgram(), "--pipe", formatOf(picture)}, input.dump(), bytes);
  if (code != 0 || bytes.empty()) throw common::Error("plot_curve could not draw '" + picture + "'");
  common::writeFileAtomically(picture, bytes);
}

}  // namespace snapwing::tools
