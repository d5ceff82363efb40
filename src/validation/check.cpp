#include "snapwing/validation/check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace snapwing::validation {

std::string verdictName(Verdict verdict) {
  if (verdict == Verdict::PASS) return "pass";
  if (verdict == Verdict::UNDECIDED) return "UNDECIDED";
  return verdict == Verdict::FAIL ? "FAIL" : "reported";
}

std::string allowedWords(const Check& check) {
  const auto number = [](double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.4g", value);
    return std::string(text);
  };
  const bool below = std::isnan(check.low), above = std::isnan(check.high);
  if (below && above) return "";
  if (below) return "at most " + number(check.high) + " " + check.unit;
  if (above) return "at least " + number(check.low) + " " + check.unit;
  return number(check.low) + " .. " + number(check.high) + " " + check.unit;
}

Check within(const std::string& name, double value, double low, double high, const std::string& unit,
             const std::string& words) {
  const bool holds = value == value && !(value < low) && !(value > high);
  return {name, holds ? Verdict::PASS : Verdict::FAIL, value, low, high, unit, words};
}

Check within(const std::string& name, const Estimate& value, double low, double high, const std::string& unit,
             const std::string& words) {
  Check check = within(name, value.value, low, high, unit, words);
  check.error = value.error;
  const double least = value.value - value.error, most = value.value + value.error;
  const bool whole = !(least < low) && !(most > high), none = most < low || least > high;
  // A bar that is no number decides nothing for the good.
  if (std::isfinite(value.value) && !none && !(whole && std::isfinite(value.error))) {
    check.verdict = Verdict::UNDECIDED;
    check.words +=
        std::string(words.empty() ? "" : "; ") + "the error bar reaches across the limit: smaller cells decide";
  }
  return check;
}

Check yesOrNo(const std::string& name, bool holds, const std::string& words) {
  Check check;
  check.name = name;
  check.verdict = holds ? Verdict::PASS : Verdict::FAIL;
  check.words = words;
  return check;
}

Check reported(const std::string& name, double value, const std::string& unit, const std::string& words) {
  Check check;
  check.name = name;
  check.verdict = Verdict::REPORTED;
  check.value = value;
  check.unit = unit;
  check.words = words;
  return check;
}

namespace {

bool has(const std::vector<Check>& checks, Verdict verdict) {
  return std::any_of(checks.begin(), checks.end(), [&](const Check& check) { return check.verdict == verdict; });
}

}  // namespace

bool passed(const std::vector<Check>& checks) {
  return !has(checks, Verdict::FAIL) && !has(checks, Verdict::UNDECIDED) && has(checks, Verdict::PASS);
}

bool undecided(const std::vector<Check>& checks) {
  return !has(checks, Verdict::FAIL) && has(checks, Verdict::UNDECIDED);
}

Verdict verdictOf(const std::vector<Check>& checks) {
  return passed(checks) ? Verdict::PASS : undecided(checks) ? Verdict::UNDECIDED : Verdict::FAIL;
}

}  // namespace snapwing::validation
