// The command `predict`: `snapwing` calls this program for it.
#include "command_line.h"
#include "commands.h"

int main(int argc, char** argv) {
  return snapwing::tools::runCommandLine(argc, argv, snapwing::tools::addPredictCommand);
}
