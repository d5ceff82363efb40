#include "snapwing/elasticity/material.h"

#include <cmath>
#include <string>

#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"

namespace snapwing::elasticity {

void Material::validate() const {
  const auto refuse = [](const char* name, double value, const char* allowed) {
    throw common::Error(std::string(name) + " is " + common::toText(value) + "; allowed: " + allowed);
  };
  if (!std::isfinite(youngs_modulus) || youngs_modulus <= 0) refuse("youngs_modulus", youngs_modulus, "> 0 Pa");
  if (!(poisson_ratio >= 0 && poisson_ratio < 0.5)) refuse("poisson_ratio", poisson_ratio, "0 <= nu < 0.5");
  if (!std::isfinite(mass_density) || mass_density < 0) refuse("mass_density", mass_density, ">= 0 kg/m3");
}

}  // namespace snapwing::elasticity
