#pragma once
/// `radio_bridge --check`: asks a flight controller everything that arming depends on and prints what is ready and what
/// is not. Sends questions only, never a channel.

#include <string>

#include "controller_checks.h"
#include "snapwing/link/transport.h"

namespace snapwing::link {

enum class CheckResult { READY = 0, NOT_READY = 1, NO_ANSWER = 3 };  ///< also the program's exit code

struct CheckReport {
  CheckResult result = CheckResult::NO_ANSWER;
  std::string text;  ///< lines for a terminal; the last one says "ready" or "not ready"
};

/// The list for answers at hand.
/// @param slowest  [s] longest time between a question and its answer
CheckReport reportOn(const ControllerAnswers& answers, const ControllerRules& rules, double slowest);

/// Opens the line, asks, waits for answers on the monotonic clock.
/// @param patience  [s] for all of it
CheckReport checkController(Transport& line, MspVersion version, const ControllerRules& rules, double patience);

}  // namespace snapwing::link
