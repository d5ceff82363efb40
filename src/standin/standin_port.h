#pragma once
/// The stand-in flight controller's receiver port: hears MSP, SBUS or CRSF and answers MSP. Pure: bytes and times in,
/// bytes out.

#include <string>

#include "snapwing/common/loan.h"
#include "snapwing/link/crsf.h"
#include "snapwing/link/sbus.h"
#include "standin_controller.h"

namespace snapwing::standin {

class StandinPort {
 public:
  /// @param protocol  "msp", "sbus" or "crsf"
  /// @param now       [s] power on
  StandinPort(const std::string& protocol, StandinController& controller, double now);

  /// A new line: what the old one began is void.
  void reset() { msp_.reset(); }
  void take(const std::uint8_t* bytes, std::size_t size, double now);
  /// Serves what is due and steps the controller. @return bytes of answers written to `out`
  std::size_t step(double now, std::uint8_t* out, std::size_t capacity) { return msp_.step(now, out, capacity); }

 private:
  void onTicks(const link::Ticks& ticks, int (*microseconds)(int), double now);

  std::string protocol_;
  common::Loan<StandinController> controller_;
  StandinMsp msp_;
  link::SbusParser sbus_;
  link::CrsfParser crsf_;
};

}  // namespace snapwing::standin
