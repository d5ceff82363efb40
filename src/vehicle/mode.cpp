#include "snapwing/vehicle/mode.h"

#include <algorithm>
#include <cctype>

#include "snapwing/common/error.h"

namespace snapwing::vehicle {

std::string modeName(Mode mode) {
  switch (mode) {
    case Mode::FIXED_WING:
      return "F";
    case Mode::QUADROTOR:
      return "Q";
    case Mode::UNKNOWN:
      break;
  }
  return "unknown";
}

Mode modeFromName(const std::string& text) {
  std::string lower = text;
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  if (lower == "f" || lower == "fixed_wing") return Mode::FIXED_WING;
  if (lower == "q" || lower == "quadrotor") return Mode::QUADROTOR;
  throw common::Error("mode is '" + text + "'; allowed: F (fixed_wing) or Q (quadrotor)");
}

Mode otherMode(Mode mode) {
  if (mode == Mode::UNKNOWN) throw common::Error("mode is unknown; a switch needs F or Q to start from");
  return mode == Mode::FIXED_WING ? Mode::QUADROTOR : Mode::FIXED_WING;
}

}  // namespace snapwing::vehicle
