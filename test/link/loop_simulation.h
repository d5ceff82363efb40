#pragma once
/// Bridge loop and stand-in flight controller joined by a line of bytes, all on one fake clock of 1 ms.

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <functional>
#include <memory>
#include <optional>

#include "bridge_loop.h"
#include "standin_controller.h"

namespace snapwing::link::test {

/// A line that can be broken, blocked or made to take half of each frame. It talks through pipes of the kernel's
/// making, so that Transport's own reading and writing is used.
class PipeTransport : public Transport {
 public:
  ~PipeTransport() override { PipeTransport::unplug(); }
  void maintain(double now) override;
  int backlog() const override;
  bool flush() override;
  /// The far end's view.
  std::size_t farRead(std::uint8_t* out, std::size_t capacity);
  void farWrite(const std::uint8_t* bytes, std::size_t size);
  void unplug();
  int waiting() const;

  bool plugged = true;         ///< false: cannot connect
  bool hides_backlog = false;  ///< as a pseudo-terminal does
  bool keeps_all = false;      ///< nothing can be flushed, as by some adapters
  std::size_t takes = 0;       ///< [bytes] at most, of each write; 0 = all

 private:
  long send(const std::uint8_t* bytes, std::size_t size) override;
  int far_ = -1;
};

/// Operator, bridge, line and controller. Any part can be left out for a while.
class Simulation {
 public:
  explicit Simulation(const standin::StandinSettings& fc = quickStandin(), const BridgeSettings& bridge = {},
                      const std::set<std::string>& allowed = {});
  static standin::StandinSettings quickStandin();

  /// Lets time pass; calls `each` every millisecond.
  void run(double seconds, const std::function<void()>& each = {});
  bool runUntil(double limit, const std::function<bool()>& done);
  void arm();
  Refusal pulse(double throttle, double duration);
  /// Puts a pulse into the bridge's inbox; mixed if a pitch is given.
  void command(double throttle, double duration, std::optional<double> pitch = {});
  void command(const PulseShape& shape);
  /// A new process in the place of a killed one.
  void restartBridge();

  double now = 50.0;
  bool bridge_runs = true;  ///< false: killed or stopped
  bool line_open = true;    ///< false: bytes wait in the pipes, nobody reads
  bool operator_runs = true;
  bool arm_switch = false, deadman = true, reset = false;
  std::optional<Channels> pilot;  ///< sticks and switches of a pilot's receiver, a frame every 9 ms; empty = off
  std::int64_t pulse_id = 0;

  PipeTransport line;
  standin::StandinController fc;
  standin::StandinMsp port;
  std::unique_ptr<BridgeLoop> bridge;
  int highest_motor = 0;  ///< since last set to 0

 private:
  void step();
  Stamp stamp();
  BridgeSettings bridge_settings_;
  std::set<std::string> allowed_;
  std::int64_t session_ = 1000, number_ = 0;
  double next_beat_ = 0, next_pilot_ = 0;
};

}  // namespace snapwing::link::test
