#include "snapwing/mpm/coarsening.h"

#include "snapwing/common/enum_names.h"
#include "snapwing/elasticity/density_interpolation.h"

namespace snapwing::mpm {

namespace {

constexpr common::EnumNames<Coarsening, 2> NAMES("coarsening", {"mass", "stiffness"});

}  // namespace

Coarsening coarseningFromName(const std::string& name) { return NAMES.value(name); }

std::string coarseningName(Coarsening coarsening) { return NAMES.name(coarsening); }

double coarseningPower(Coarsening coarsening) {
  return coarsening == Coarsening::MASS ? 1 : elasticity::DensityInterpolation().power;
}

}  // namespace snapwing::mpm
