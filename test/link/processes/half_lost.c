/* Loses a share of the datagrams that a program sends to a multicast group, as a bad network would. Preloaded by tests;
   SNAPWING_LOSS is the share. */
#define _GNU_SOURCE
#include <arpa/inet.h>
#include <dlfcn.h>
#include <netinet/in.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

ssize_t sendto(int socket, const void *bytes, size_t size, int flags, const struct sockaddr *there, socklen_t length) {
  static ssize_t (*real)(int, const void *, size_t, int, const struct sockaddr *, socklen_t);
  static _Atomic unsigned state;
  if (!real) {
    *(void **)&real = dlsym(RTLD_NEXT, "sendto");
    state = (unsigned)getpid() * 2654435761u + 1;
  }
  if (there && there->sa_family == AF_INET && IN_MULTICAST(ntohl(((const struct sockaddr_in *)there)->sin_addr.s_addr))) {
    unsigned old = state, next;
    do {
      next = old * 1664525u + 1013904223u;
    } while (!atomic_compare_exchange_weak(&state, &old, next));
    const char *share = getenv("SNAPWING_LOSS");
    if (share && (next >> 8) / 16777216.0 < atof(share)) return (ssize_t)size;
  }
  return real(socket, bytes, size, flags, there, length);
}
