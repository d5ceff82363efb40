#pragma once
/// Receives the flight controller's motor outputs over UDP on the loopback interface; the latest good datagram wins.

#include <chrono>
#include <cstdint>

#include "snapwing/link/motor_stream.h"

namespace snapwing::nodes {

class MotorReceiver {
 public:
  /// @param port     UDP port on 127.0.0.1
  /// @param timeout  [s] without a good datagram after which all outputs are 0 (the motors have no signal)
  /// @throws common::Error if the port cannot be had
  MotorReceiver(std::uint16_t port, double timeout);
  ~MotorReceiver();
  MotorReceiver(const MotorReceiver&) = delete;
  MotorReceiver& operator=(const MotorReceiver&) = delete;

  /// Outputs in force now, [0, 1]; does not wait.
  link::MotorOutputs outputs();
  /// Datagrams taken and thrown away so far.
  unsigned long received() const { return received_; }
  unsigned long rejected() const { return rejected_; }

 private:
  int socket_;
  double timeout_;
  link::MotorOutputs latest_{};
  std::chrono::steady_clock::time_point when_;
  unsigned long received_ = 0;
  unsigned long rejected_ = 0;
};

}  // namespace snapwing::nodes
