#include "snapwing/elasticity/material.h"

#include <cmath>
#include <string>

#include "snapwing/common/plain_text.h"
#include "snapwing/common/require.h"

namespace snapwing::elasticity {

void Material::validate() const {
  const common::Require require;
  require.positive("youngs_modulus", youngs_modulus, " Pa");
  require(poisson_ratio >= 0 && poisson_ratio < 0.5, "poisson_ratio", poisson_ratio, "0 <= nu < 0.5");
  require.notNegative("mass_density", mass_density, " kg/m3");
}

}  // namespace snapwing::elasticity
