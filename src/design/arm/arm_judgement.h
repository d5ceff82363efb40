#pragma once
/// What a vehicle wishes of an arm against what its check found.

#include "snapwing/design/arm/arm_check.h"

namespace snapwing::design {

/// Fills the targets and verdicts of a check whose cases and table are there.
void judgeAll(const ArmTargets& wanted, ArmCheck& check);

}  // namespace snapwing::design
