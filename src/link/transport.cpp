#include "snapwing/link/transport.h"

#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace snapwing::link {

std::optional<int> portNumber(const std::string& text) {
  const bool digits = !text.empty() && text.size() <= 5 && text.find_first_not_of("0123456789") == std::string::npos;
  const int number = digits ? std::stoi(text) : -1;
  return number >= 0 && number <= 65535 ? std::optional<int>(number) : std::nullopt;
}

void Transport::opened(bool padding) {
  connected_ = true;
  padding_ = padding;
  last_error_ = 0;
  setRest(0);
  blocked_since_ = -1;
  ++connections_;
}

void Transport::setRest(std::size_t size) {
  rest_size_ = size;
  open_bytes_->store(static_cast<std::uint32_t>(size));
}

void Transport::close() {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
  connected_ = false;
  setRest(0);
}

std::size_t Transport::read(std::uint8_t* out, std::size_t capacity) {
  if (!connected_) return 0;
  const ssize_t got = ::read(descriptor_, out, capacity);
  if (got > 0) return static_cast<std::size_t>(got);
  const bool nothing_yet = got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR);
  if (!nothing_yet) {  // 0 is the end of a socket and of an unplugged line
    failed(got < 0 ? errno : 0);
    close();
  }
  return 0;
}

long Transport::send(const std::uint8_t* bytes, std::size_t size) { return ::write(descriptor_, bytes, size); }

bool Transport::sendRest() {
  while (rest_size_ > 0) {
    const long sent = send(rest_, rest_size_);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0 && errno != EAGAIN && errno != EWOULDBLOCK) {
      failed(errno);
      close();
    }
    if (sent <= 0) return false;
    setRest(rest_size_ - static_cast<std::size_t>(sent));
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
  setRest(0);
  if (!connected_) return;
  if (!flush()) return close();
  if (!padding_) return;
  // The line may have taken a part of what was thrown away, and not every line tells.
  std::memset(rest_, 0, PADDING);
  setRest(PADDING);
}

bool Transport::write(const std::uint8_t* bytes, std::size_t size, double now) {
  if (!connected_ || size > sizeof rest_) return false;
  if (!sendRest() || backlog() > backlogLimit()) return connected_ && blocked(now);
  open_bytes_->store(static_cast<std::uint32_t>(size));  // whoever is killed from here on may have sent a part
  long sent = 0;
  do {
    sent = send(bytes, size);
  } while (sent < 0 && errno == EINTR);
  if (sent < 0) {
    const int error = errno;
    open_bytes_->store(0);
    if (error == EAGAIN || error == EWOULDBLOCK) return blocked(now);
    failed(error);
    close();
    return false;
  }
  blocked_since_ = -1;
  const auto taken = static_cast<std::size_t>(sent);
  // Half a frame is on the line: its rest must follow before anything else, or the far end loses its place.
  std::memcpy(rest_, bytes + taken, size - taken);
  setRest(size - taken);
  return taken == size;
}

}  // namespace snapwing::link
