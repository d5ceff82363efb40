// Designs a small bistable mechanism and writes its density: design_mechanism DESIGN.yaml DENSITY.csv
#include <cstdio>

#include "snapwing/common/error.h"
#include "snapwing/design/arm/arm_run.h"

int main(int argc, char** argv) {
  if (argc != 3) return std::fprintf(stderr, "usage: design_mechanism DESIGN.yaml DENSITY.csv\n"), 2;
  try {
    const auto settings = snapwing::design::loadArmDesignSettings(argv[1]);
    snapwing::design::ArmRunOptions options;
    options.progress = [](const snapwing::design::ArmProgress& now) {
      std::fprintf(stderr, "stage %d, volume %.3f, grey %.3f\n", now.stage, now.volume, now.grey);
      return false;  // true would cancel
    };
    const auto run = snapwing::design::runArmDesign(settings, options);
    snapwing::design::saveDensityCsv(run.field, settings.name, argv[2]);
    for (std::size_t k = 0; k < run.travels.size(); ++k) std::printf("%.6g m: %.6g N\n", run.travels[k], run.forces[k]);
    return run.worst.empty() ? 0 : 1;
  } catch (const snapwing::common::Error& error) {
    return std::fprintf(stderr, "error: %s\n", error.what()), 2;
  }
}
