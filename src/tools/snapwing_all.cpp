// All commands of `snapwing`, which calls this program for those that it has not itself.
#include "command_line.h"
#include "commands.h"

namespace snapwing::tools {

namespace {

void addAll(CLI::App& app, int& exit_code) {
  addCurveCommand(app, exit_code);
  addDesignArmCommand(app, exit_code);
  addDesignWingCommand(app, exit_code);
  addPredictCommand(app, exit_code);
  addPlanCommand(app, exit_code);
  addTrialCommand(app, exit_code);
  addValidateCommand(app, exit_code);
  addVehicleCommand(app, exit_code);
}

}  // namespace

}  // namespace snapwing::tools

int main(int argc, char** argv) { return snapwing::tools::runCommandLine(argc, argv, snapwing::tools::addAll); }
