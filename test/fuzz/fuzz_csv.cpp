/// libFuzzer: densities and measured rows as comma separated values. The first byte states the number of cells.
#include <sys/stat.h>

#include "fuzz_file.h"
#include "snapwing/mpm/density_field.h"
#include "snapwing/scene/rung.h"

using namespace snapwing;
using fuzz::taken;

namespace snapwing::statics {
solver::Enforcement enforcementFromName(const std::string&) { return solver::Enforcement::ELIMINATION; }
std::string enforcementName(solver::Enforcement) { return "elimination"; }
}  // namespace snapwing::statics

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  const int stated = data[0] % 8;
  const std::string path = fuzz::asFile(data + 1, size - 1, ".csv");
  mpm::DensityField field;
  if (taken([&] { field = mpm::loadDensityCsv(path, 1, 1, {stated, stated}); })) {
    for (const double rho : field.value) fuzz::require(rho == -1 || (rho >= 0 && rho <= 1));
    taken([&] { field.resampled(0.25); });
    mpm::outline(field, 0.5);
  }
  const std::string folder = path + "_trade";
  ::mkdir(folder.c_str(), 0700);
  ::rename(path.c_str(), (folder + "/t.csv").c_str());
  scene::Scene scene;
  scene.content_sha256 = "ab";
  taken([&] { scene::chooseRow(scene::loadTrade(folder), scene, 0.1, {}); });
  return 0;
}
