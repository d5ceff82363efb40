/// trial_bag FOLDER...: run.bag of trials that `snapwing trial -o FOLDER` has run; `snapwing trial --bag` calls it. No
/// node: it needs no master.

#include "trial_bag.h"

#include <CLI/CLI.hpp>
#include <cstdio>

#include "snapwing/common/error.h"

int main(int argc, char** argv) {
  CLI::App app{"Writes run.bag into folders of `snapwing trial`: frames, markers, joint states and mode over time"};
  std::vector<std::string> folders;
  app.add_option("folder", folders, "with series.csv and summary.json")->required();
  try {
    app.parse(argc, argv);
    for (const std::string& folder : folders) std::printf("%s\n", snapwing::nodes::writeTrialBag(folder).c_str());
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "trial_bag: %s\n", error.what());
    return 2;
  }
}
