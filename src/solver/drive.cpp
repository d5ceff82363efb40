#include "snapwing/solver/drive.h"

#include "snapwing/common/error.h"

namespace snapwing::solver {

Drive driveFromName(const std::string& name) {
  for (const Drive drive : {Drive::ELIMINATION, Drive::AUGMENTED_LAGRANGIAN, Drive::MULTIPLIERS}) {
    if (driveName(drive) == name) return drive;
  }
  throw common::Error("drive is '" + name + "'; allowed: elimination, augmented_lagrangian, multipliers");
}

std::string driveName(Drive drive) {
  if (drive == Drive::ELIMINATION) return "elimination";
  return drive == Drive::MULTIPLIERS ? "multipliers" : "augmented_lagrangian";
}

}  // namespace snapwing::solver
