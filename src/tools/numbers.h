#pragma once
/// Checks of numbers among the options: finite, in range, and the range in the message. CLI11's own let NaN pass, and
/// read 010 as 8.

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string>

namespace snapwing::tools {

namespace numbers {

inline std::string refusal(const std::string& given, const std::string& allowed) {
  return "'" + given + "'; allowed: " + allowed;
}

/// The finite decimal number that the whole text is; otherwise NaN. strtod alone also takes " 1" and 0x1, which is 1.
inline double decimal(const std::string& text) {
  if (text.empty() || text.find_first_not_of("0123456789+-.eE") != std::string::npos) return NAN;
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return *end == '\0' && std::isfinite(value) ? value : NAN;
}

template <class Number>
std::string rangeText(Number low, Number high, const std::string& unit) {
  std::ostringstream text;
  text << low << " .. " << high;
  if (!unit.empty() && unit != "1") text << " " << unit;
  return text.str();
}

}  // namespace numbers

/// A finite decimal number in [low, high]. @param above_low  low itself is not allowed
inline CLI::Validator realNumber(double low, double high, const std::string& unit, bool above_low = false) {
  const std::string allowed = (above_low ? "above " : "") + numbers::rangeText(low, high, unit);
  return CLI::Validator(
      [=](std::string& given) {
        const double value = numbers::decimal(given);
        const bool good = value <= high && (above_low ? value > low : value >= low);
        return good ? std::string() : numbers::refusal(given, "a number, " + allowed);
      },
      allowed);
}

/// A whole number in [low, high], written without leading zeros: 010 would be 8 to some and 10 to others.
inline CLI::Validator wholeNumber(long low, long high) {
  const std::string allowed = numbers::rangeText(low, high, "");
  return CLI::Validator(
      [=](std::string& given) {
        const std::string digits = given.substr(!given.empty() && given[0] == '-' ? 1 : 0);
        const bool plain = !digits.empty() && digits.size() < 18 &&
                           digits.find_first_not_of("0123456789") == std::string::npos &&
                           (digits == "0" || digits[0] != '0');
        const long value = plain ? std::strtol(given.c_str(), nullptr, 10) : 0;
        return plain && value >= low && value <= high ? std::string()
                                                      : numbers::refusal(given, "a whole number, " + allowed);
      },
      allowed);
}

/// A share between 0 and 1, as 2% or 0.02; turns the percentage into the share.
inline CLI::Validator shareOrPercent() {
  return CLI::Validator(
      [](std::string& given) {
        const bool percent = !given.empty() && given.back() == '%';
        const std::string digits = given.substr(0, given.size() - (percent ? 1 : 0));
        const double value = numbers::decimal(digits) * (percent ? 0.01 : 1.0);
        if (!(value > 0 && value < 1)) {
          return numbers::refusal(given, "a percentage between 0% and 100% as 2%, or a share between 0 and 1 as 0.02");
        }
        std::ostringstream text;
        text.precision(17);
        text << value;
        given = text.str();
        return std::string();
      },
      "SHARE");
}

}  // namespace snapwing::tools
