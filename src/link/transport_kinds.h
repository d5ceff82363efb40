#pragma once
/// The three kinds of lines behind makeTransport().

#include <netinet/in.h>

#include "snapwing/link/transport.h"

namespace snapwing::link {

class TcpTransport : public Transport {
 public:
  TcpTransport(const std::string& host, const std::string& port, const LineSettings& settings);
  ~TcpTransport() override { close(); }
  void maintain(double now) override;

 private:
  int backlog() const override;
  /// Bytes sent but not acknowledged count too: a network that returns would deliver them late. The far end may take 40
  /// ms to acknowledge, so five frames are let through.
  int backlogLimit() const override { return 160; }
  int emptyLimit() const override { return backlogLimit(); }
  bool flush() override { return false; }
  void finishConnecting();
  sockaddr_storage address_{};  ///< looked up once: a name service may block
  socklen_t address_size_ = 0;
  bool padding_;
};

class SerialTransport : public Transport {
 public:
  SerialTransport(std::string device, const LineSettings& settings) : device_(std::move(device)), settings_(settings) {}
  ~SerialTransport() override { close(); }
  void maintain(double now) override;

 private:
  int backlog() const override;
  bool flush() override;
  std::string device_;
  LineSettings settings_;
};

class PtyTransport : public Transport {
 public:
  PtyTransport(const std::string& link, const LineSettings& settings);
  ~PtyTransport() override;
  void maintain(double now) override;

 private:
  int backlog() const override;
  bool flush() override;
  std::string link_, slave_;
  int slave_descriptor_ = -1;
};

}  // namespace snapwing::link
