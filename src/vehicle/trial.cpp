#include "snapwing/vehicle/trial.h"

#include <cmath>

#include "snapwing/common/enum_names.h"
#include "snapwing/common/error.h"
#include "snapwing/common/require.h"
#include "snapwing/vehicle/vehicle.h"
#include "snapwing/vehicle/wing_table.h"

namespace snapwing::vehicle {

namespace {
constexpr common::EnumNames<Mount, 3> MOUNTS("mount", {"free", "boom", "held"});
}  // namespace

Mount mountFromName(const std::string& text) { return MOUNTS.value(text); }

Mount mountFor(const Vehicle& vehicle, const std::string& text, const std::string& who) {
  if (text == "auto") return vehicle.boom.given ? Mount::BOOM : Mount::FREE;
  const Mount mount = mountFromName(text);
  if (mount == Mount::BOOM) vehicle.requireBoom(who);
  return mount;
}

std::string mountName(Mount mount) { return MOUNTS.name(mount); }

std::optional<bool> wingsFromName(const std::string& text) {
  if (text == "auto") return std::nullopt;
  if (text == "on" || text == "off") return text == "on";
  throw common::Error("wings is '" + text + "'; allowed: auto, on, off");
}

std::string wingsName(const std::optional<bool>& wings) {
  if (!wings) return "auto";
  return *wings ? "on" : "off";
}

namespace {
const common::Require require("trial");
void requireShare(const char* name, const std::optional<double>& share) {
  if (share) require.within(name, *share, 0, 1);
}
}  // namespace

void Trial::validate() const {
  require(std::abs(gravity) <= 100.0, "gravity", gravity, "-100 .. 100 m/s2");
  require(std::abs(initial_speed) <= 200.0, "initial_speed", initial_speed, "-200 .. 200 m/s");
  require(mount != Mount::HELD || initial_speed == 0.0, "initial_speed", initial_speed, "0 when the ring is held");
  require(std::isfinite(push), "push", push, "a finite force");
  require(mount != Mount::HELD || push == 0.0, "push", push, "0 when the ring is held");
  require(horizon > 0.0 && horizon <= 60.0, "horizon", horizon, "above 0, up to 60 s");
  if (wings.value_or(false) && mount == Mount::BOOM) refuseWingsOnBoom("trial");
  requireShare("initial_thrust_fraction", initial_thrust_fraction);
  requireShare("final_thrust_fraction", final_thrust_fraction);
}

}  // namespace snapwing::vehicle
