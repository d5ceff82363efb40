/* Preloaded into radio_bridge, it makes a fault happen inside, on the thread wanted, when the test asks for it: the file named by
   SNAPWING_FAULT holds { fault to do, its argument [ms], moment at which it was done [us of the real monotonic clock] }. Processes that
   the bridge forks (guardian, log) are left alone. */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

struct order {
  volatile int64_t fault, argument, moment;
};
/* Faults; the tens say where: 10 main loop, 20 a thread that receives from the network, 30 any other thread. */
enum { SEGV = 1, ABORT = 2, MEMORY = 3, STALL = 4, SPIN = 5, FPE = 6, EXIT = 7, TERM = 8 };
enum { STILL_CLOCK = 40, SUSPENDED = 41, WALL_SET = 42 };

static struct order* order;
static pid_t owner;

static int64_t real_microseconds(clockid_t clock) {
  struct timespec now;
  syscall(SYS_clock_gettime, clock, &now);
  return now.tv_sec * 1000000LL + now.tv_nsec / 1000;
}

__attribute__((constructor)) static void load(void) {
  const char* name = getenv("SNAPWING_FAULT");
  const int file = name ? open(name, O_RDWR | O_CLOEXEC) : -1;
  if (file < 0) return;
  void* memory = mmap(NULL, sizeof(struct order), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  close(file);
  if (memory != MAP_FAILED) order = memory;
  owner = getpid();
}

static void take_memory(void) {
  for (;;) {
    char* block = malloc(1 << 20);
    if (block == NULL) abort(); /* as operator new does when nobody catches */
    memset(block, 1, 1 << 20);
  }
}

static void perhaps(int where) {
  if (order == NULL || order->fault / 10 != where || order->fault >= 40 || getpid() != owner) return;
  const int64_t fault = order->fault % 10, argument = order->argument;
  order->fault = 0;
  order->moment = real_microseconds(CLOCK_MONOTONIC);
  struct timespec pause = {argument / 1000, argument % 1000 * 1000000};
  if (fault == SEGV) *(volatile int*)8 = 1;
  if (fault == FPE) raise(SIGFPE);
  if (fault == ABORT) abort();
  if (fault == MEMORY) take_memory();
  if (fault == STALL) nanosleep(&pause, NULL);
  if (fault == EXIT) _exit(3);
  if (fault == TERM) raise(SIGTERM); /* between the loop's look at its signals and its sleep */
  while (fault == SPIN) {
  }
}

static int in_main(void) { return syscall(SYS_gettid) == getpid(); }

int poll(struct pollfd* list, nfds_t count, int timeout) {
  if (order != NULL) perhaps(in_main() ? 1 : 3);
  struct timespec limit = {timeout / 1000, timeout % 1000 * 1000000L};
  return (int)syscall(SYS_ppoll, list, count, timeout < 0 ? NULL : &limit, NULL, 8);
}

ssize_t recvmsg(int socket, struct msghdr* message, int flags) {
  const ssize_t got = syscall(SYS_recvmsg, socket, message, flags);
  if (order != NULL && !in_main()) perhaps(2);
  return got;
}

ssize_t recvfrom(int socket, void* bytes, size_t size, int flags, struct sockaddr* from, socklen_t* from_size) {
  const ssize_t got = syscall(SYS_recvfrom, socket, bytes, size, flags, from, from_size);
  if (order != NULL && !in_main()) perhaps(2);
  return got;
}

ssize_t recv(int socket, void* bytes, size_t size, int flags) { return recvfrom(socket, bytes, size, flags, NULL, NULL); }

/* STILL_CLOCK: the monotonic clock stands still from the moment of the order while the others go on. SUSPENDED: boot time and wall clock
   have gone on for `argument` ms, and the monotonic clock has not. */
int clock_gettime(clockid_t clock, struct timespec* out) {
  const int result = (int)syscall(SYS_clock_gettime, clock, out);
  if (result != 0 || order == NULL || order->fault < 40 || getpid() != owner) return result;
  const int64_t fault = order->fault;
  if (order->moment == 0) order->moment = real_microseconds(CLOCK_MONOTONIC);
  const int mine = fault == STILL_CLOCK ? clock == CLOCK_MONOTONIC
                                        : clock == CLOCK_REALTIME || (fault == SUSPENDED && clock == CLOCK_BOOTTIME);
  if (!mine) return result;
  int64_t shown = order->moment;
  if (fault != STILL_CLOCK) shown = real_microseconds(clock) + 1000 * order->argument;
  out->tv_sec = shown / 1000000;
  out->tv_nsec = shown % 1000000 * 1000;
  return result;
}
