#include <CLI/CLI.hpp>

#include "commands.h"

namespace snapwing::tools {

CLI::App* designCommand(CLI::App& app) {
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
    if (command->get_name() == "design") return command;
  }
  CLI::App* design = app.add_subcommand("design", "Design a part of the vehicle");
  design->require_subcommand(1);
  return design;
}

}  // namespace snapwing::tools
