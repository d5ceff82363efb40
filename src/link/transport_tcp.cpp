#include <fcntl.h>
#include <linux/sockios.h>
#include <netdb.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "snapwing/common/error.h"
#include "transport_kinds.h"

namespace snapwing::link {

TcpTransport::TcpTransport(const std::string& host, const std::string& port, const LineSettings& settings)
    : padding_(settings.padding) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_family = AF_UNSPEC;
  addrinfo* found = nullptr;
  const int error = getaddrinfo(host.c_str(), port.c_str(), &hints, &found);
  if (error != 0) throw common::Error("tcp:" + host + ":" + port + ": " + gai_strerror(error));
  std::memcpy(&address_, found->ai_addr, found->ai_addrlen);
  address_size_ = found->ai_addrlen;
  freeaddrinfo(found);
}

void TcpTransport::maintain(double now) {
  if (connected_) return;
  if (descriptor_ >= 0) {
    finishConnecting();
    if (connected_ || now < next_attempt_) return;
    failed(ETIMEDOUT);
    close();  // no answer in time: start anew
  }
  if (now < next_attempt_) return;
  next_attempt_ = now + 0.25;
  descriptor_ = ::socket(address_.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (descriptor_ < 0) return failed(errno);
  const int on = 1;
  const linger drop_rest{1, 0};  // closing throws away what was not delivered
  setsockopt(descriptor_, SOL_SOCKET, SO_LINGER, &drop_rest, sizeof drop_rest);
  setsockopt(descriptor_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  if (::connect(descriptor_, reinterpret_cast<const sockaddr*>(&address_), address_size_) == 0) {
    opened(padding_);
  } else if (errno != EINPROGRESS) {
    failed(errno);
    close();
  }
}

void TcpTransport::finishConnecting() {
  pollfd waiting{descriptor_, POLLOUT, 0};
  if (::poll(&waiting, 1, 0) <= 0) return;
  int error = 0;
  socklen_t size = sizeof error;
  getsockopt(descriptor_, SOL_SOCKET, SO_ERROR, &error, &size);
  if (error == 0) {
    opened(padding_);
  } else {
    failed(error);
    close();
  }
}

int TcpTransport::backlog() const {
  int waiting = 0;
  return ioctl(descriptor_, SIOCOUTQ, &waiting) == 0 ? waiting : 0;
}

std::unique_ptr<Transport> makeTransport(const std::string& where, const LineSettings& settings) {
  const std::size_t colon = where.find(':');
  const std::string kind = where.substr(0, colon);
  const std::string rest = colon == std::string::npos ? "" : where.substr(colon + 1);
  if (kind == "tcp") {
    const std::size_t last = rest.rfind(':');
    if (last != std::string::npos && last > 0 && portNumber(rest.substr(last + 1)).value_or(0) > 0) {
      return std::make_unique<TcpTransport>(rest.substr(0, last), rest.substr(last + 1), settings);
    }
  }
  if (kind == "serial" && !rest.empty()) return std::make_unique<SerialTransport>(rest, settings);
  if (kind == "pty" && !rest.empty()) return std::make_unique<PtyTransport>(rest, settings);
  throw common::SettingError("radio bridge", "fc", where,
                             "tcp:HOST:PORT with a port within [1, 65535], serial:/dev/NAME or pty:LINK");
}

}  // namespace snapwing::link
