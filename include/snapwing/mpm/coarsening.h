#pragma once
/// Which mean of a density field coarser cells conserve.

#include <string>

namespace snapwing::mpm {

enum class Coarsening {
  MASS,       ///< mean of rho
  STIFFNESS,  ///< mean of rho^p, p of the stiffness (elasticity::DensityInterpolation)
};
/// mass or stiffness. @throws common::Error
Coarsening coarseningFromName(const std::string& name);
std::string coarseningName(Coarsening coarsening);
/// The power for DensityField::resampled [1].
double coarseningPower(Coarsening coarsening);

}  // namespace snapwing::mpm
