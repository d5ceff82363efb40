#include <gtest/gtest.h>

#include <set>

#include "snapwing/planning/mode_machine.h"

namespace snapwing::planning {
namespace {

TEST(ModeMachine, EachStateAndEventHasAtMostOneRow) {
  std::set<std::pair<MachineState, MachineEvent>> seen;
  for (const MachineRow& row : machineTable()) {
    EXPECT_TRUE(seen.insert({row.from, row.event}).second) << machineStateName(row.from);
    EXPECT_NE(row.from, row.to);
  }
}

TEST(ModeMachine, ASwitchAndBack) {
  ModeMachine machine;
  EXPECT_EQ(machine.mode(), common::Mode::UNKNOWN);
  EXPECT_FALSE(machine.handle(MachineEvent::PULSE_SENT));  // not from a mode that is not known
  EXPECT_TRUE(machine.handle(MachineEvent::ESTIMATE_F));
  EXPECT_EQ(machine.mode(), common::Mode::FIXED_WING);
  EXPECT_TRUE(machine.handle(MachineEvent::PULSE_SENT));
  EXPECT_EQ(machine.state(), MachineState::SWITCHING_TO_Q);
  EXPECT_EQ(machine.mode(), common::Mode::UNKNOWN);
  EXPECT_FALSE(machine.handle(MachineEvent::ESTIMATE_F));     // has not had time to act
  EXPECT_FALSE(machine.handle(MachineEvent::ESTIMATE_LOST));  // expected while it moves
  EXPECT_TRUE(machine.handle(MachineEvent::ESTIMATE_Q));
  EXPECT_EQ(machine.mode(), common::Mode::QUADROTOR);
  EXPECT_TRUE(machine.handle(MachineEvent::PULSE_SENT));
  EXPECT_TRUE(machine.handle(MachineEvent::ESTIMATE_F));
  EXPECT_EQ(machine.mode(), common::Mode::FIXED_WING);
}

TEST(ModeMachine, FailedSwitchIsFoundOutAfterTheTimeout) {
  ModeMachine machine(common::Mode::QUADROTOR);
  machine.handle(MachineEvent::PULSE_SENT);
  EXPECT_FALSE(machine.handle(MachineEvent::ESTIMATE_Q));
  EXPECT_TRUE(machine.handle(MachineEvent::TIMEOUT));
  EXPECT_EQ(machine.mode(), common::Mode::UNKNOWN);
  EXPECT_TRUE(machine.handle(MachineEvent::ESTIMATE_Q));
  EXPECT_EQ(machine.mode(), common::Mode::QUADROTOR);
}

TEST(ModeMachine, AccidentalSwitchIsFollowed) {
  ModeMachine machine(common::Mode::FIXED_WING);
  EXPECT_TRUE(machine.handle(MachineEvent::ESTIMATE_Q));
  EXPECT_EQ(machine.mode(), common::Mode::QUADROTOR);
}

}  // namespace
}  // namespace snapwing::planning
