// The `snapwing` command line: everything that a node does online can be done here, offline, on the same core.
#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>

#include "commands.h"
#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"

namespace {

constexpr int BAD_INPUT = 2;
constexpr int INTERNAL_ERROR = 3;

int run(int argc, char** argv) {
  CLI::App app{"snapwing: design, predict and plan mode switches of shape-changing drones"};
  app.set_version_flag("--version", snapwing::common::version());
  app.require_subcommand(1);
  app.footer(
      "Exit code: 0 good, 1 an honest negative outcome (refused, not converged), 2 bad input, 3 internal error.");
  int exit_code = 0;
  snapwing::tools::addCurveCommand(app, exit_code);
  snapwing::tools::addDesignArmCommand(app, exit_code);
  snapwing::tools::addDesignWingCommand(app, exit_code);
  snapwing::tools::addPredictCommand(app, exit_code);
  snapwing::tools::addPlanCommand(app, exit_code);
  snapwing::tools::addVehicleCommand(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : BAD_INPUT;
  }
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const snapwing::common::Error& e) {
    std::cerr << "snapwing: " << e.what() << "\n";
    return BAD_INPUT;
  } catch (const std::exception& e) {
    std::cerr << "snapwing: internal error: " << e.what() << "\n";
    return INTERNAL_ERROR;
  }
}
