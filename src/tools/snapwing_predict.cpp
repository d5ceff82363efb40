// The commands `predict` and `plan`: `snapwing` calls this program for them.
#include "command_line.h"
#include "commands.h"

int main(int argc, char** argv) {
  return snapwing::tools::runCommandLine(argc, argv, [](CLI::App& app, int& exit_code) {
    snapwing::tools::addPredictCommand(app, exit_code);
    snapwing::tools::addPlanCommand(app, exit_code);
  });
}
