#pragma once
/// One question that a validation answers with yes or no, and the numbers behind the answer.

#include <limits>
#include <string>
#include <vector>

#include "snapwing/validation/estimate.h"

namespace snapwing::validation {

enum class Verdict {
  PASS,
  FAIL,
  UNDECIDED,  ///< the error bar reaches across a limit; does not pass
  REPORTED,   ///< a number for the reader; does not gate
};
std::string verdictName(Verdict verdict);  ///< "pass", "FAIL", "UNDECIDED", "reported"

struct Check {
  std::string name;  ///< e.g. "F -> Q, planar, nominal: end mode"
  Verdict verdict = Verdict::FAIL;
  double value = std::numeric_limits<double>::quiet_NaN();  ///< NaN: there is no number
  double low = std::numeric_limits<double>::quiet_NaN();    ///< allowed range; NaN: no bound
  double high = std::numeric_limits<double>::quiet_NaN();
  std::string unit;   ///< of value, low and high
  std::string words;  ///< what was found, one sentence
  double error = 0;   ///< half width of the value's error bar, in its unit
};

/// Its range with unit, e.g. "-5 .. 5 ms" or "at most 80 mm"; empty without bounds.
std::string allowedWords(const Check& check);

/// PASS if low <= value <= high; a value that is NaN fails. A bound that is NaN does not bind.
Check within(const std::string& name, double value, double low, double high, const std::string& unit,
             const std::string& words = {});
/// The same with the whole error bar: PASS if all of it is allowed, FAIL if none of it is, else UNDECIDED.
Check within(const std::string& name, const Estimate& value, double low, double high, const std::string& unit,
             const std::string& words = {});
Check yesOrNo(const std::string& name, bool holds, const std::string& words);
Check reported(const std::string& name, double value, const std::string& unit, const std::string& words = {});

/// True if no check failed or is undecided, and there is at least one that passed.
bool passed(const std::vector<Check>& checks);
/// True if no check failed, but one is undecided.
bool undecided(const std::vector<Check>& checks);
/// PASS, UNDECIDED or FAIL by the two above.
Verdict verdictOf(const std::vector<Check>& checks);

}  // namespace snapwing::validation
