// The command `predict` as a module that `snapwing` loads when it is asked for.
#include "command_line.h"
#include "commands.h"

extern "C" __attribute__((visibility("default"))) int snapwingPredict(int argc, char** argv) {
  return snapwing::tools::runCommandLine(argc, argv, snapwing::tools::addPredictCommand);
}
