#include "snapwing/link/transport.h"

#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace snapwing::link {

void Transport::opened() {
  connected_ = true;
  rest_size_ = 0;
  blocked_since_ = -1;
  ++connections_;
}

void Transport::close() {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
  connected_ = false;
  rest_size_ = 0;
}

std::size_t Transport::read(std::uint8_t* out, std::size_t capacity) {
  if (!connected_) return 0;
  const ssize_t got = ::read(descriptor_, out, capacity);
  if (got > 0) return static_cast<std::size_t>(got);
  const bool nothing_yet = got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR);
  if (!nothing_yet) close();  // 0 is the end of a socket and of an unplugged line
  return 0;
}

long Transport::send(const std::uint8_t* bytes, std::size_t size) { return ::write(descriptor_, bytes, size); }

bool Transport::sendRest() {
  while (rest_size_ > 0) {
    const long sent = send(rest_, rest_size_);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0 && errno != EAGAIN && errno != EWOULDBLOCK) close();
    if (sent <= 0) return false;
    rest_size_ -= static_cast<std::size_t>(sent);
    std::memmove(rest_, rest_ + sent, rest_size_);
  }
  return true;
}

bool Transport::blocked(double now) {
  if (blocked_since_ < 0) blocked_since_ = now;
  if (now - blocked_since_ <= BLOCKED_LIMIT) return false;
  blocked_since_ = now;
  discard();
  return false;
}

void Transport::discard() {
  rest_size_ = 0;
  if (connected_ && !flush()) close();
}

bool Transport::write(const std::uint8_t* bytes, std::size_t size, double now) {
  if (!connected_ || size > sizeof rest_) return false;
  if (!sendRest() || backlog() > backlogLimit()) return connected_ && blocked(now);
  long sent = 0;
  do {
    sent = send(bytes, size);
  } while (sent < 0 && errno == EINTR);
  if (sent < 0) {
    if (errno != EAGAIN && errno != EWOULDBLOCK) {
      close();
      return false;
    }
    return blocked(now);
  }
  blocked_since_ = -1;
  const auto taken = static_cast<std::size_t>(sent);
  if (taken == size) return true;
  // Half a frame is on the line: its rest must follow before anything else, or the far end loses its place.
  rest_size_ = size - taken;
  std::memcpy(rest_, bytes + taken, rest_size_);
  return false;
}

}  // namespace snapwing::link
