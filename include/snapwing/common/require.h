#pragma once
/// Numbers that must lie within bounds.

#include <string>
#include <string_view>
#include <utility>

#include "snapwing/common/error.h"

namespace snapwing::common {

/// Refuses numbers in the name of one asker, with messages such as "planner: threads is 0; allowed: 1 .. 256". All
/// throw Error.
class Require {
 public:
  /// @param who  asks; may be left out of the messages
  explicit Require(std::string who = "") : who_(std::move(who)) {}
  /// @param allowed  what would have been accepted, with unit
  void operator()(bool good, std::string_view key, double value, std::string_view allowed) const;
  void within(std::string_view key, double value, double low, double high) const;
  /// Finite and above 0. @param unit  of the limit in the message, e.g. " s"
  void positive(std::string_view key, double value, std::string_view unit = "") const;
  /// Finite and 0 or more.
  void notNegative(std::string_view key, double value, std::string_view unit = "") const;

 private:
  std::string who_;
};

}  // namespace snapwing::common
