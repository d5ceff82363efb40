#pragma once
/// Names of an enum's values in files and options.

#include <array>
#include <string>

#include "snapwing/common/error.h"

namespace snapwing::common {

/// For an enum with values 0, 1, ...; names in the same order.
template <class Enum, std::size_t N>
class EnumNames {
 public:
  /// @param key  name of the setting in messages
  constexpr EnumNames(const char* key, const std::array<const char*, N>& names) : key_(key), names_(names) {}

  /// @throws Error naming the key and all allowed names
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
