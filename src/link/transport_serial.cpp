// asm/termbits.h and termios.h cannot be included together, so everything with termios2 lives in this file.
#include <asm/ioctls.h>
#include <asm/termbits.h>
#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "snapwing/common/error.h"
#include "snapwing/link/transport.h"
#include "transport_kinds.h"

namespace snapwing::link {

bool configureSerial(int descriptor, const LineSettings& settings) {
  struct termios2 line {};
  if (ioctl(descriptor, TCGETS2, &line) != 0) return false;
  line.c_iflag = 0;
  line.c_oflag = 0;
  line.c_lflag = 0;
  line.c_cflag = CS8 | CREAD | CLOCAL | BOTHER;
  if (settings.parity == Parity::EVEN) line.c_cflag |= PARENB;
  if (settings.stop_bits == 2) line.c_cflag |= CSTOPB;
  line.c_ispeed = static_cast<speed_t>(settings.baud);
  line.c_ospeed = static_cast<speed_t>(settings.baud);
  line.c_cc[VMIN] = 1;
  line.c_cc[VTIME] = 0;
  if (ioctl(descriptor, TCSETS2, &line) != 0 || ioctl(descriptor, TCGETS2, &line) != 0) return false;
  // A driver takes the nearest rate that it can make; a receiver bears 2.5 %.
  const double off = static_cast<double>(line.c_ospeed) / settings.baud - 1.0;
  if (off > -0.025 && off < 0.025) return true;
  errno = EINVAL;
  return false;
}

void SerialTransport::maintain(double now) {
  if (connected_ || now < next_attempt_) return;
  next_attempt_ = now + 0.25;
  descriptor_ = ::open(device_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor_ < 0) return failed(errno);
  if (!configureSerial(descriptor_, settings_)) {
    failed(errno);
    close();
    return;
  }
  ioctl(descriptor_, TIOCEXCL);
  ioctl(descriptor_, TCFLSH, TCIOFLUSH);
  opened(settings_.padding);
}

int SerialTransport::backlog() const {
  int waiting = 0;
  return ioctl(descriptor_, TIOCOUTQ, &waiting) == 0 ? waiting : 0;
}

bool SerialTransport::flush() { return ioctl(descriptor_, TCFLSH, TCOFLUSH) == 0; }

int openPseudoTerminal(std::string& slave) {
  const int master = ::open("/dev/ptmx", O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  int unlock = 0;
  unsigned number = 0;
  if (master < 0 || ioctl(master, TIOCSPTLCK, &unlock) != 0 || ioctl(master, TIOCGPTN, &number) != 0) {
    const std::string why = std::strerror(errno);
    if (master >= 0) ::close(master);
    throw common::Error("no pseudo-terminal: " + why);
  }
  slave = "/dev/pts/" + std::to_string(number);
  configureSerial(master, LineSettings{});
  return master;
}

namespace {

/// Where a link leads; empty, and errno says why, if it is none.
std::string targetOf(const std::string& link) {
  char target[64];  // what is longer is cut, and no pseudo-terminal
  const ssize_t size = ::readlink(link.c_str(), target, sizeof target);
  return size > 0 ? std::string(target, static_cast<std::size_t>(size)) : "";
}

/// Anything but a link to a pseudo-terminal is somebody's: a key, a device, a name that udev gave.
void requireFree(const std::string& link) {
  const std::string target = targetOf(link);
  if (target.empty() ? errno == ENOENT : target.rfind("/dev/pts/", 0) == 0) return;
  throw common::FileError(link, "is there already and is no link to a pseudo-terminal; allowed: a new name");
}

}  // namespace

PtyTransport::PtyTransport(const std::string& link, const LineSettings& settings) : link_(link) {
  requireFree(link);
  descriptor_ = openPseudoTerminal(slave_);
  // The far end stays open here too, so that a peer that comes and goes does not look like a broken line.
  slave_descriptor_ = ::open(slave_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  ::unlink(link.c_str());
  if (slave_descriptor_ < 0 || ::symlink(slave_.c_str(), link.c_str()) != 0) {
    throw common::FileError(link, std::string("cannot link pseudo-terminal: ") + std::strerror(errno));
  }
  opened(settings.padding);
}

PtyTransport::~PtyTransport() {
  if (targetOf(link_) == slave_) ::unlink(link_.c_str());
  if (slave_descriptor_ >= 0) ::close(slave_descriptor_);
}

void PtyTransport::maintain(double /*now*/) {}

int PtyTransport::backlog() const {
  int waiting = 0;
  return ioctl(slave_descriptor_, FIONREAD, &waiting) == 0 ? waiting : 0;
}

bool PtyTransport::flush() { return ioctl(slave_descriptor_, TCFLSH, TCIFLUSH) == 0; }

}  // namespace snapwing::link
