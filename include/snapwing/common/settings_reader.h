#pragma once
/// Strict reading of YAML settings: every key must be known, present, of the right type, with the expected unit and
/// within its range. Reading a map ends with finish(), which refuses keys that were not read.

#include <limits>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace YAML {
class Node;
}

namespace snapwing::common {

/// An uncertain number, uniformly distributed within value +- plus_minus, both in SI units.
struct Quantity {
  double value = std::numeric_limits<double>::quiet_NaN();
  double plus_minus = 0.0;
  double low() const { return value - plus_minus; }
  double high() const { return value + plus_minus; }
};

/// Closed range of allowed values, in the unit of the key.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};

/// Reads one YAML map strictly. Sub-maps have their own readers, with the same file name. All readers of values throw
/// SettingError for a missing key, a wrong type, or a value out of range; numbers are returned in the given unit.
class SettingsReader {
 public:
  /// @throws FileError if the file cannot be read or is no YAML map
  static SettingsReader fromFile(const std::string& path);
  /// @param where  name used in messages in place of a file name
  static SettingsReader fromText(const std::string& text, const std::string& where);

  SettingsReader(SettingsReader&&) noexcept;
  SettingsReader& operator=(SettingsReader&&) noexcept;
  ~SettingsReader();

  bool has(const std::string& key) const;
  /// Sub-map. @throws SettingError if missing or no map
  SettingsReader map(const std::string& key);
  /// Sequence of maps, named key[0], key[1] ... in messages.
  std::vector<SettingsReader> list(const std::string& key);
  /// Keys of this map in the file's order (for maps with names chosen by the user).
  std::vector<std::string> keys() const;

  /// Finite number. The functions ...Or return `fallback` if the key is missing. @param unit  for messages
  double number(const std::string& key, const Range& range, const std::string& unit);
  double numberOr(const std::string& key, double fallback, const Range& range, const std::string& unit);
  int integer(const std::string& key, int low, int high);
  int integerOr(const std::string& key, int fallback, int low, int high);
  bool boolean(const std::string& key);
  bool booleanOr(const std::string& key, bool fallback);
  std::string text(const std::string& key);
  std::string textOr(const std::string& key, const std::string& fallback);
  /// One of the allowed words. @throws SettingError listing them
  std::string choice(const std::string& key, const std::vector<std::string>& allowed);
  /// List of non-empty texts.
  std::vector<std::string> texts(const std::string& key);
  /// List of numbers. @param count  required length; 0: any, also none
  std::vector<double> numbers(const std::string& key, std::size_t count, const Range& range, const std::string& unit);

  /// A number with its source: `{value: , unit: , plus_minus: , source: }`. The unit must be the expected one, `source`
  /// must not be empty, plus_minus is optional (0), and value +- plus_minus must lie in the range.
  Quantity quantity(const std::string& key, const std::string& unit, const Range& range);

  /// @throws SettingError naming the first key that was not read, and the keys that are known here
  void finish() const;

  /// Name of the file, for messages and for relative paths.
  const std::string& where() const;
  /// `path` as written if absolute, else relative to the folder of the file.
  std::string resolvePath(const std::string& path) const;
  /// All files passed to resolvePath() so far, in this map or any other of the file.
  const std::vector<std::string>& namedFiles() const;
  /// Canonical text of the map, independent of the order of keys, comments and number formats.
  /// @param except  dotted keys to leave out; "a[].b" is b of every entry of a, "*.b" is b in any map but the first
  std::string content(const std::set<std::string>& except) const;
  /// Full dotted key of `key` in this map.
  std::string fullKey(const std::string& key) const;
  /// Throws a SettingError for `key` of this map: for checks that span several keys.
  [[noreturn]] void fail(const std::string& key, const std::string& value, const std::string& allowed) const;

 private:
  SettingsReader(const YAML::Node& node, std::string where, std::string prefix);
  YAML::Node child(const std::string& key, const std::string& allowed);
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace snapwing::common
