#pragma once
/// Checks of numbers against their allowed range.

#include <string>
#include <string_view>
#include <utility>

#include "snapwing/common/error.h"

namespace snapwing::common {

/// Checks numbers and throws Error with messages such as "planner: threads is 0; allowed: 1 .. 256".
class Require {
 public:
  /// @param who  first word of messages; empty: none
  explicit Require(std::string who = "") : who_(std::move(who)) {}
  /// Requires `good`. @param allowed  allowed values for the message, with unit
  void operator()(bool good, std::string_view key, double value, std::string_view allowed) const;
  /// Requires low <= value <= high.
  void within(std::string_view key, double value, double low, double high) const;
  /// Requires a finite value above 0. @param unit  for the message, e.g. " s"
  void positive(std::string_view key, double value, std::string_view unit = "") const;
  /// Requires a finite value >= 0.
  void notNegative(std::string_view key, double value, std::string_view unit = "") const;

 private:
  std::string who_;
};

}  // namespace snapwing::common
