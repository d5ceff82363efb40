#pragma once
/// Words that files and options use for the values of an enum.

#include <array>
#include <string>

#include "snapwing/common/error.h"

namespace snapwing::common {

/// Of an enum whose values count from 0, in their order.
template <class Enum, std::size_t N>
class EnumNames {
 public:
  /// @param key  what a message calls the setting
  constexpr EnumNames(const char* key, const std::array<const char*, N>& names) : key_(key), names_(names) {}

  /// @throws Error naming the key and all words that are allowed
  Enum value(const std::string& name) const {
    std::string allowed;
    for (std::size_t k = 0; k < N; ++k) {
      if (name == names_[k]) return static_cast<Enum>(k);
      allowed += (k == 0 ? "" : ", ") + std::string(names_[k]);
    }
    throw Error(key_ + (" is '" + name) + "'; allowed: " + allowed);
  }
  std::string name(Enum value) const { return names_.at(static_cast<std::size_t>(value)); }

 private:
  const char* key_;
  std::array<const char*, N> names_;
};

}  // namespace snapwing::common
