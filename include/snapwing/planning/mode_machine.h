#pragma once
/// The mode machine, written as a table: state, event, guard, next. What no row names changes nothing.

#include <string>
#include <vector>

#include "snapwing/common/mode.h"

namespace snapwing::planning {

enum class MachineState { UNKNOWN, FIXED_WING, QUADROTOR, SWITCHING_TO_Q, SWITCHING_TO_F };

enum class MachineEvent {
  PULSE_SENT,     ///< a switching pulse was commanded
  ESTIMATE_F,     ///< estimator sure of F
  ESTIMATE_Q,     ///< estimator sure of Q
  ESTIMATE_LOST,  ///< estimator no longer sure
  TIMEOUT,        ///< a switch took too long
};

struct MachineRow {
  MachineState from;
  MachineEvent event;
  MachineState to;
};

/// The whole machine, for tests and documents.
const std::vector<MachineRow>& machineTable();
std::string machineStateName(MachineState state);

/// While SWITCHING, estimates of the mode left behind do nothing until the pulse has had time to act: the caller fires
/// TIMEOUT when it has waited long enough, and the estimate decides from then on.
class ModeMachine {
 public:
  explicit ModeMachine(common::Mode initial = common::Mode::UNKNOWN);
  /// @return true if the state changed
  bool handle(MachineEvent event);
  MachineState state() const { return state_; }
  /// F or Q when settled, else UNKNOWN.
  common::Mode mode() const;

 private:
  MachineState state_;
};

}  // namespace snapwing::planning
