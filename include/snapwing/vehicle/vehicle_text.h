#pragma once
/// A vehicle file as text: changed line by line, so that numbers, sources and comments of the author stay as they are.

#include <string>
#include <vector>

namespace snapwing::vehicle {

/// A new value, a text in quotes if YAML needs them, for the `key: value` below the line `section:` (or of the
/// top-level `key` where section == key); the comment behind it was about the old value and goes. Text in which there
/// is no such line stays as it is.
std::string withValue(const std::string& text, const std::string& section, const std::string& key,
                      const std::string& value);

/// Without these top-level keys, each with the lines that belong to it.
std::string withoutKeys(const std::string& text, const std::vector<std::string>& keys);

}  // namespace snapwing::vehicle
