#pragma once
/// Exceptions of snapwing: violated preconditions, invalid settings and invalid files throw. A numerical outcome (not
/// converged, infeasible, cancelled) is a status in a result; functions that return no status throw it as Error.

#include <stdexcept>
#include <string>

namespace snapwing::common {

/// Base of every exception that snapwing throws on purpose.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A setting is unknown, missing, of the wrong type or out of range.
class SettingError : public Error {
 public:
  /// @param where    file (and line, if known) that holds the setting
  /// @param key      full dotted key, e.g. "masses.centre.value"
  /// @param value    refused value as written; empty if the key is missing
  /// @param allowed  allowed values, with unit
  SettingError(const std::string& where, const std::string& key, const std::string& value, const std::string& allowed);
  const std::string& key() const { return key_; }

 private:
  std::string key_;
};

/// A file cannot be read, written or parsed.
class FileError : public Error {
 public:
  /// @param path  the file; @param why  the reason
  FileError(const std::string& path, const std::string& why);
};

}  // namespace snapwing::common
