#pragma once
/// How driven ports and joints are imposed.

#include <string>

namespace snapwing::solver {

enum class Enforcement {
  ELIMINATION,           ///< exactly, by eliminating unknowns
  AUGMENTED_LAGRANGIAN,  ///< inner minimisation at fixed multipliers, outer updates lambda += rho g
  MULTIPLIERS,           ///< Newton on the saddle point, by the Schur complement of the constraints
};
/// As scene files and the command line write it. @throws common::Error
Enforcement enforcementFromName(const std::string& name);
std::string enforcementName(Enforcement enforcement);

}  // namespace snapwing::solver
