#include "snapwing/link/realtime.h"

#include <sched.h>
#include <sys/prctl.h>

#include <cstring>

namespace snapwing::link {
namespace {

char* arguments = nullptr;
std::size_t arguments_size = 0;

}  // namespace

bool takeRealtimePriority(int priority) {
  sched_param wanted{};
  wanted.sched_priority = priority;
  return priority > 0 && sched_setscheduler(0, SCHED_FIFO, &wanted) == 0;
}

void leaveRealtimePriority() {
  const sched_param none{};
  sched_setscheduler(0, SCHED_OTHER, &none);
}

void keepArguments(int argc, char** argv) {
  if (argc <= 0) return;
  arguments = argv[0];
  const char* end = argv[argc - 1] + std::strlen(argv[argc - 1]);
  arguments_size = static_cast<std::size_t>(end - argv[0]);
}

void nameProcess(const char* name) {
  prctl(PR_SET_NAME, name, 0, 0, 0);
  if (arguments_size == 0) return;
  std::memset(arguments, 0, arguments_size);
  std::strncpy(arguments, name, arguments_size - 1);
}

}  // namespace snapwing::link
