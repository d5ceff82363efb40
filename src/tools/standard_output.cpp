#include "standard_output.h"

#include <poll.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <iostream>

#include "command_line.h"

namespace snapwing::tools {

namespace {

/// Except where the reader has gone, as `| head` does: files are written before.
bool printed() {
  const bool good = std::cout.flush().good() && std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  pollfd out{STDOUT_FILENO, POLLOUT, 0};
  return good || (::poll(&out, 1, 0) == 1 && (out.revents & POLLERR) != 0);
}

}  // namespace

void keepFailedWrites() {
  // A limit on a file's size is one, too.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

int afterPrinting(int code) {
  if (printed()) return code;
  std::cerr << "snapwing: the standard output cannot be written\n";
  return code == 0 ? BAD_INPUT : code;
}

}  // namespace snapwing::tools
