#include "motor_receiver.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "snapwing/common/error.h"

namespace snapwing::nodes {

MotorReceiver::MotorReceiver(std::uint16_t port, double timeout)
    : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)), timeout_(timeout) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (socket_ < 0 || ::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    const std::string why = std::strerror(errno);
    if (socket_ >= 0) ::close(socket_);
    throw common::Error("motor outputs: UDP port " + std::to_string(port) + " on the loopback: " + why);
  }
}

MotorReceiver::~MotorReceiver() { ::close(socket_); }

link::MotorOutputs MotorReceiver::outputs() {
  std::uint8_t bytes[256];
  for (;;) {
    const ssize_t size = ::recv(socket_, bytes, sizeof bytes, 0);
    if (size < 0) break;
    if (link::decodeMotors(bytes, static_cast<std::size_t>(size), latest_)) {
      when_ = std::chrono::steady_clock::now();
      ++received_;
    } else {
      ++rejected_;
    }
  }
  const std::chrono::duration<double> age = std::chrono::steady_clock::now() - when_;
  if (received_ == 0 || age.count() > timeout_) return {};
  return latest_;
}

}  // namespace snapwing::nodes
