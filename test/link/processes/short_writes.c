/* Preloaded into a program, it makes every third write to a terminal take only a part of the bytes, as a full driver does. */
#define _GNU_SOURCE
#include <sys/syscall.h>
#include <unistd.h>

ssize_t write(int descriptor, const void* bytes, size_t size) {
  static unsigned turn = 0;
  const int mine = size > 1 && isatty(descriptor);
  if (mine && ++turn % 3 == 0) size = 1 + turn % (size - 1);
  return (ssize_t)syscall(SYS_write, descriptor, bytes, size);
}
