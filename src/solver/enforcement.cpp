#include "snapwing/solver/enforcement.h"

#include "snapwing/common/error.h"

namespace snapwing::solver {

Enforcement enforcementFromName(const std::string& name) {
  for (const Enforcement enforcement :
       {Enforcement::ELIMINATION, Enforcement::AUGMENTED_LAGRANGIAN, Enforcement::MULTIPLIERS}) {
    if (enforcementName(enforcement) == name) return enforcement;
  }
  throw common::Error("drive is '" + name + "'; allowed: elimination, augmented_lagrangian, multipliers");
}

std::string enforcementName(Enforcement enforcement) {
  if (enforcement == Enforcement::ELIMINATION) return "elimination";
  return enforcement == Enforcement::MULTIPLIERS ? "multipliers" : "augmented_lagrangian";
}

}  // namespace snapwing::solver
