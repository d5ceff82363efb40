#include "snapwing/common/require.h"

#include <cmath>

#include "snapwing/common/plain_text.h"

namespace snapwing::common {

void Require::operator()(bool good, std::string_view key, double value, std::string_view allowed) const {
  if (good) return;
  std::string text = who_.empty() ? "" : who_ + ": ";
  text.append(key).append(" is ").append(toText(value)).append("; allowed: ").append(allowed);
  throw Error(text);
}

void Require::within(std::string_view key, double value, double low, double high) const {
  if (!(value >= low && value <= high)) (*this)(false, key, value, toText(low) + " .. " + toText(high));
}

void Require::positive(std::string_view key, double value, std::string_view unit) const {
  if (!(value > 0 && std::isfinite(value))) (*this)(false, key, value, std::string("above 0").append(unit));
}

void Require::notNegative(std::string_view key, double value, std::string_view unit) const {
  if (!(value >= 0 && std::isfinite(value))) (*this)(false, key, value, std::string("0 or more").append(unit));
}

}  // namespace snapwing::common
