#pragma once
/// Real-time priority, where this user may have it.

namespace snapwing::link {

/// SCHED_FIFO for the calling thread and those that it starts afterwards.
/// @param priority  1..99; 0 or less asks for nothing
/// @return whether it was granted
bool takeRealtimePriority(int priority);
/// Back to normal priority for the calling thread alone: what may turn without waiting, as ROS's spinner does while
/// another thread works on its queue, must not keep that thread, and everybody else, from the processor.
void leaveRealtimePriority();

/// Of the operator's end: below the bridge and above everything else, so that a busy machine does not look like a dead
/// operator.
constexpr int OPERATOR_PRIORITY = 30;
/// Of what stands for other hardware, so that a busy machine does not look like a dead flight controller or a vehicle
/// that stands still: the stand-in flight controller above the guardian, the simulated vehicle below the operator's
/// end.
constexpr int STANDIN_PRIORITY = 60;
constexpr int SIMULATION_PRIORITY = 20;

/// The name under which ps and pkill see this process; call once, early. Child processes take names of their own.
void keepArguments(int argc, char** argv);
void nameProcess(const char* name);

}  // namespace snapwing::link
