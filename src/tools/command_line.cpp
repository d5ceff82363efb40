#include "command_line.h"

#include <CLI/CLI.hpp>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"
#include "standard_output.h"

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
  keepFailedWrites();
  return afterPrinting(guarded(argc, argv, add));
}

}  // namespace snapwing::tools
