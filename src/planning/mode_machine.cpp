#include "snapwing/planning/mode_machine.h"

#include <algorithm>

namespace snapwing::planning {

using Event = MachineEvent;
using State = MachineState;

const std::vector<MachineRow>& machineTable() {
  static const std::vector<MachineRow> table = {
      {State::UNKNOWN, Event::ESTIMATE_F, State::FIXED_WING},
      {State::UNKNOWN, Event::ESTIMATE_Q, State::QUADROTOR},
      {State::FIXED_WING, Event::PULSE_SENT, State::SWITCHING_TO_Q},
      {State::FIXED_WING, Event::ESTIMATE_Q, State::QUADROTOR},
      {State::FIXED_WING, Event::ESTIMATE_LOST, State::UNKNOWN},
      {State::QUADROTOR, Event::PULSE_SENT, State::SWITCHING_TO_F},
      {State::QUADROTOR, Event::ESTIMATE_F, State::FIXED_WING},
      {State::QUADROTOR, Event::ESTIMATE_LOST, State::UNKNOWN},
      {State::SWITCHING_TO_Q, Event::ESTIMATE_Q, State::QUADROTOR},
      {State::SWITCHING_TO_Q, Event::TIMEOUT, State::UNKNOWN},
      {State::SWITCHING_TO_F, Event::ESTIMATE_F, State::FIXED_WING},
      {State::SWITCHING_TO_F, Event::TIMEOUT, State::UNKNOWN},
  };
  return table;
}

std::string machineStateName(MachineState state) {
  switch (state) {
    case State::FIXED_WING:
      return "F";
    case State::QUADROTOR:
      return "Q";
    case State::SWITCHING_TO_Q:
      return "switching to Q";
    case State::SWITCHING_TO_F:
      return "switching to F";
    case State::UNKNOWN:
      break;
  }
  return "unknown";
}

ModeMachine::ModeMachine(common::Mode initial) : state_(State::UNKNOWN) {
  if (initial == common::Mode::FIXED_WING) state_ = State::FIXED_WING;
  if (initial == common::Mode::QUADROTOR) state_ = State::QUADROTOR;
}

bool ModeMachine::handle(MachineEvent event) {
  const auto& table = machineTable();
  const auto row = std::find_if(table.begin(), table.end(),
                                [&](const MachineRow& r) { return r.from == state_ && r.event == event; });
  if (row == table.end()) return false;
  state_ = row->to;
  return true;
}

common::Mode ModeMachine::mode() const {
  if (state_ == State::FIXED_WING) return common::Mode::FIXED_WING;
  if (state_ == State::QUADROTOR) return common::Mode::QUADROTOR;
  return common::Mode::UNKNOWN;
}

}  // namespace snapwing::planning
