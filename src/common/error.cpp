#include "snapwing/common/error.h"

namespace snapwing::common {

namespace {
std::string settingMessage(const std::string& where, const std::string& key, const std::string& value,
                           const std::string& allowed) {
  const std::string what = value.empty() ? "'" + key + "' is missing" : "'" + key + "' is " + value;
  return where + ": " + what + "; allowed: " + allowed;
}
}  // namespace

SettingError::SettingError(const std::string& where, const std::string& key, const std::string& value,
                           const std::string& allowed)
    : Error(settingMessage(where, key, value, allowed)), key_(key) {}

FileError::FileError(const std::string& path, const std::string& why) : Error(path + ": " + why) {}

}  // namespace snapwing::common
