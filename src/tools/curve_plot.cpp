// `snapwing curve --plot`: hands the curve to scripts/plot_curve (matplotlib).
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <vector>

#include "curve_options.h"
#include "snapwing/common/error.h"
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

int run(std::vector<std::string> words) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  if (posix_spawn(&child, arguments[0], nullptr, nullptr, arguments.data(), environ) != 0) return -1;
  int status = 0;
  if (waitpid(child, &status, 0) != child || !WIFEXITED(status)) return -1;
  return WEXITSTATUS(status);
}

}  // namespace

void requirePlotting() {
  if (run({plotProgram(), "--check"}) != 0)
    throw common::Error("--plot needs Python 3 with matplotlib (Debian: python3-matplotlib)");
}

void plotCurve(const std::string& csv, const std::string& summary, const std::string& picture) {
  const std::string csv_file = picture + ".csv.part", summary_file = picture + ".json.part";
  common::writeFileAtomically(csv_file, csv);
  common::writeFileAtomically(summary_file, summary);
  const int code = run({plotProgram(), csv_file, summary_file, picture});
  std::filesystem::remove(csv_file);
  std::filesystem::remove(summary_file);
  if (code != 0) throw common::Error("plot_curve could not write '" + picture + "'");
}

}  // namespace snapwing::tools
