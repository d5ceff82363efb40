#pragma once
/// Edits of a vehicle file's text, line by line, so that all other numbers, sources and comments stay unchanged.

#include <string>
#include <vector>

namespace snapwing::vehicle {

/// Replaces the value of `key: value` below the line `section:`, or of the top-level `key` where section == key. The
/// value is quoted if YAML requires it. A comment on the same line is removed, since it belonged to the old value. Text
/// without such a line is returned unchanged.
std::string withValue(const std::string& text, const std::string& section, const std::string& key,
                      const std::string& value);

/// Removes these top-level keys with their lines.
std::string withoutKeys(const std::string& text, const std::vector<std::string>& keys);

}  // namespace snapwing::vehicle
