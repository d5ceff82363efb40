#include "snapwing/link/realtime.h"

#include <sched.h>

namespace snapwing::link {

bool takeRealtimePriority(int priority) {
  sched_param wanted{};
  wanted.sched_priority = priority;
  return priority > 0 && sched_setscheduler(0, SCHED_FIFO, &wanted) == 0;
}

}  // namespace snapwing::link
