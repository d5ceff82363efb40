#pragma once
/// How the constraints of driven ports and joints are enforced.

#include <string>

namespace snapwing::solver {

enum class Enforcement {
  ELIMINATION,           ///< elimination of unknowns: exact
  AUGMENTED_LAGRANGIAN,  ///< inner minimisation at fixed multipliers, outer updates lambda += rho g
  MULTIPLIERS,           ///< Newton on the saddle point, by the Schur complement of the constraints
};
/// elimination, augmented_lagrangian or multipliers, as in scene files and options. @throws common::Error
Enforcement enforcementFromName(const std::string& name);
std::string enforcementName(Enforcement enforcement);

}  // namespace snapwing::solver
