#pragma once
/// The exception family of snapwing: broken preconditions, bad settings and bad files throw; a numerical outcome
/// (no convergence, infeasible, cancelled) is a status in a result and never an exception.

#include <stdexcept>
#include <string>

namespace snapwing::common {

/// Base of every exception that snapwing throws on purpose.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A setting is unknown, missing, mistyped or out of range.
class SettingError : public Error {
 public:
  /// @param where    file (and line, if known) that holds the setting
  /// @param key      full dotted key, e.g. "masses.centre.value"
  /// @param value    offending value as written; empty if the key is missing
  /// @param allowed  what would have been accepted, with unit
  SettingError(const std::string& where, const std::string& key, const std::string& value, const std::string& allowed);
  const std::string& key() const { return key_; }

 private:
  std::string key_;
};

/// A file cannot be read, written or understood.
class FileError : public Error {
 public:
  /// @param path  the file; @param why  what is wrong with it
  FileError(const std::string& path, const std::string& why);
};

}  // namespace snapwing::common
