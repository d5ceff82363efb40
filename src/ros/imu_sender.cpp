#include "imu_sender.h"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "snapwing/common/error.h"
#include "snapwing/link/motor_stream.h"

namespace snapwing::nodes {

ImuSender::ImuSender(std::uint16_t port)
    : port_(port), socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
  if (socket_ < 0) throw common::Error("no socket for the flight controller's accelerometer");
}

ImuSender::~ImuSender() { ::close(socket_); }

void ImuSender::send(double thrust_axis) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port_);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const link::ImuPacket packet = link::encodeImu({0.0, 0.0, thrust_axis});
  // Nobody there: the datagram is lost, as a reading of an unplugged sensor is.
  ::sendto(socket_, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&address), sizeof address);
}

}  // namespace snapwing::nodes
