#pragma once
/// Real-time priority, where this user may have it.

namespace snapwing::link {

/// SCHED_FIFO for the calling thread and those that it starts afterwards.
/// @param priority  1..99; 0 or less asks for nothing
/// @return whether it was granted
bool takeRealtimePriority(int priority);

/// Of the operator's end: below the bridge and above everything else, so that a busy machine does not look like a dead
/// operator.
constexpr int OPERATOR_PRIORITY = 30;

/// The name under which ps and pkill see this process; call once, early. Child processes take names of their own.
void keepArguments(int argc, char** argv);
void nameProcess(const char* name);

}  // namespace snapwing::link
