/// libFuzzer: YAML through the strict reader, as a scene and as a vehicle file.
#include "fuzz_file.h"
#include "snapwing/common/plain_text.h"
#include "snapwing/common/settings_reader.h"
#include "snapwing/scene/scene.h"
#include "snapwing/solver/enforcement.h"
#include "snapwing/vehicle/vehicle.h"

using namespace snapwing;
using fuzz::taken;

// The names of enforcements lie beside the solver, which is not built in here.
namespace snapwing::statics {
solver::Enforcement enforcementFromName(const std::string& name) {
  return name == "multipliers" ? solver::Enforcement::MULTIPLIERS : solver::Enforcement::ELIMINATION;
}
std::string enforcementName(solver::Enforcement) { return "elimination"; }
}  // namespace snapwing::statics

namespace {

/// Asks every key for everything that it might be.
void walk(common::SettingsReader& reader, int depth) {
  for (const std::string& key : reader.keys()) {
    taken([&] { fuzz::require(std::abs(reader.number(key, {-1e3, 1e3}, "m")) <= 1e3); });
    taken([&] { fuzz::require(std::abs(reader.integer(key, -9, 9)) <= 9); });
    taken([&] { reader.boolean(key); });
    taken([&] { fuzz::require(!reader.text(key).empty()); });
    taken([&] { reader.choice(key, {"a", "b"}); });
    taken([&] { reader.numbers(key, 0, {}, "m"); });
    taken([&] { reader.quantity(key, "m", {}); });
    if (depth > 20) continue;
    taken([&] {
      common::SettingsReader inner = reader.map(key);
      walk(inner, depth + 1);
    });
    taken([&] {
      for (common::SettingsReader& inner : reader.list(key)) walk(inner, depth + 1);
    });
  }
  taken([&] { reader.finish(); });
  reader.content({});
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  if (bytes.find("/dev") != std::string::npos || bytes.find("/proc") != std::string::npos) return -1;
  taken([&] {
    common::SettingsReader reader = common::SettingsReader::fromText(common::plainText(bytes, "fuzz"), "fuzz");
    walk(reader, 0);
  });
  const std::string path = fuzz::asFile(data, size, ".yaml");
  if (taken([&] { scene::isScene(path); })) {
    taken([&] { scene::loadScene(path); });
    taken([&] { vehicle::loadVehicle(path); });
  }
  return 0;
}
