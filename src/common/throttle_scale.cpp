#include "snapwing/common/throttle_scale.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "snapwing/common/error.h"
#include "snapwing/common/require.h"

namespace snapwing::common {

double throttleMicroseconds(const ThrottleScale& scale, double throttle) {
  Require().within("throttle", throttle, 0, 1);
  return scale.low + throttle * (scale.high - scale.low);
}

double throttleFromMicroseconds(const ThrottleScale& scale, double microseconds) {
  if (!std::isfinite(microseconds)) throw Error("throttle is not finite; allowed: microseconds");
  return std::clamp((microseconds - scale.low) / (scale.high - scale.low), 0.0, 1.0);
}

}  // namespace snapwing::common
