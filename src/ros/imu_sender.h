#pragma once
/// What the simulated vehicle's accelerometer measures, to a stand-in flight controller on the loopback.

#include <cstdint>

namespace snapwing::nodes {

class ImuSender {
 public:
  /// @param port  UDP port on 127.0.0.1. @throws common::Error without a socket
  explicit ImuSender(std::uint16_t port);
  ~ImuSender();
  ImuSender(const ImuSender&) = delete;
  ImuSender& operator=(const ImuSender&) = delete;

  /// @param thrust_axis  [m/s2] specific force along it; the other two are 0
  void send(double thrust_axis);

 private:
  std::uint16_t port_;
  int socket_;
};

}  // namespace snapwing::nodes
