#include "snapwing/elasticity/density_interpolation.h"

#include <cmath>
#include <string>

#include "snapwing/common/elementary.h"
#include "snapwing/common/plain_text.h"
#include "snapwing/common/require.h"

namespace snapwing::elasticity {

DensityInterpolation::Value DensityInterpolation::at(double density) const {
  // Solid cells are the rule, and then nothing must be rounded.
  const double power_slope = power * common::pow(density, power - 1);
  if (density >= 1) {
    const double th = common::tanh(sharpness * (1 - threshold));
    return {1, (1 - void_stiffness) * power_slope, 1,
            sharpness * (1 - th * th) / (common::tanh(sharpness * threshold) + th) * power_slope};
  }
  const double raised = common::pow(density, power);
  const double low = common::tanh(sharpness * threshold);
  const double span = low + common::tanh(sharpness * (1 - threshold));
  const double th = common::tanh(sharpness * (raised - threshold));
  Value value = {void_stiffness + (1 - void_stiffness) * raised, (1 - void_stiffness) * power_slope, (low + th) / span,
                 sharpness * (1 - th * th) / span * power_slope};
  if (value.mix < LINEAR_MIX) value.mix = value.mix_slope = 0;
  return value;
}

void DensityInterpolation::validate() const {
  const common::Require require;
  require(void_stiffness > 0 && void_stiffness < 1, "void_stiffness", void_stiffness, "in (0, 1)");
  require(power >= 1 && power <= 10, "power", power, "1 .. 10");
  require(sharpness > 0 && sharpness < 1e6, "sharpness", sharpness, "in (0, 1e6)");
  require(threshold > 0 && threshold < 1, "threshold", threshold, "in (0, 1)");
}

}  // namespace snapwing::elasticity
