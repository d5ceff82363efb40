#pragma once
/// One question that a validation answers with yes or no, and the numbers behind the answer.

#include <limits>
#include <string>
#include <vector>

namespace snapwing::validation {

enum class Verdict {
  PASS,
  FAIL,
  TOLD,  ///< a number for the reader; does not gate
};
std::string verdictName(Verdict verdict);  ///< "pass", "FAIL", "told"

struct Check {
  std::string name;  ///< e.g. "F -> Q, planar, nominal: end mode"
  Verdict verdict = Verdict::FAIL;
  double value = std::numeric_limits<double>::quiet_NaN();  ///< NaN: there is no number
  double low = std::numeric_limits<double>::quiet_NaN();    ///< allowed range; NaN: no bound
  double high = std::numeric_limits<double>::quiet_NaN();
  std::string unit;   ///< of value, low and high
  std::string words;  ///< what was found, one sentence
};

/// Its range with unit, e.g. "-5 .. 5 ms" or "at most 80 mm"; empty without bounds.
std::string allowedWords(const Check& check);

/// PASS if low <= value <= high; a value that is NaN fails. A bound that is NaN does not bind.
Check within(const std::string& name, double value, double low, double high, const std::string& unit,
             const std::string& words = {});
Check yesOrNo(const std::string& name, bool holds, const std::string& words);
Check told(const std::string& name, double value, const std::string& unit, const std::string& words = {});

/// True if no check failed and there is at least one that could.
bool passed(const std::vector<Check>& checks);

}  // namespace snapwing::validation
