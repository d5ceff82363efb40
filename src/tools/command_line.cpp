#include "command_line.h"

#include <poll.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"

namespace snapwing::tools {

namespace {

using AddCommands = void(CLI::App& app, int& exit_code);

int run(int argc, char** argv, AddCommands* add) {
  CLI::App app{"snapwing: design, predict and plan mode switches of shape-changing drones"};
  app.set_version_flag("--version", common::version());
  app.require_subcommand(1);
  app.footer("Exit code: 0 good, 1 a negative answer (refused, not converged), 2 bad input, 3 internal error.");
  int exit_code = 0;
  add(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : BAD_INPUT;
  }
  return exit_code;
}

/// What is printed must have arrived, except where the reader has gone, as `| head` does: files are written before.
bool printed() {
  const bool good = std::cout.flush().good() && std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  pollfd out{STDOUT_FILENO, POLLOUT, 0};
  return good || (::poll(&out, 1, 0) == 1 && (out.revents & POLLERR) != 0);
}

int guarded(int argc, char** argv, AddCommands* add) {
  try {
    return run(argc, argv, add);
  } catch (const common::Error& e) {
    std::cerr << "snapwing: " << e.what() << "\n";
    return BAD_INPUT;
  } catch (const std::filesystem::filesystem_error& e) {
    std::cerr << "snapwing: " << e.path1().string() << ": " << e.code().message() << "\n";
    return BAD_INPUT;
  } catch (const std::bad_alloc&) {
    std::cerr << "snapwing: not enough memory for this\n";
    return BAD_INPUT;
  } catch (const std::exception& e) {
    std::cerr << "snapwing: internal error: " << e.what() << "\n";
    return INTERNAL_ERROR;
  }
}

}  // namespace

int runCommandLine(int argc, char** argv, AddCommands* add) {
  // A reader that goes away, or a limit on a file's size, is an error of that write and not the end of the program.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  const int code = guarded(argc, argv, add);
  if (printed()) return code;
  std::cerr << "snapwing: the standard output cannot be written\n";
  return code == 0 ? BAD_INPUT : code;
}

}  // namespace snapwing::tools
