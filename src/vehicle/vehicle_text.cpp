#include "snapwing/vehicle/vehicle_text.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstring>
#include <set>
#include <sstream>

namespace snapwing::vehicle {

namespace {

std::string keyOf(const std::string& line) { return line.substr(0, line.find(':')); }

/// As YAML reads it back: names of folders may have any characters. Plain where nothing else could be meant.
std::string written(const std::string& value) {
  const auto plain = [](unsigned char c) { return std::isalnum(c) != 0 || std::strchr("_./-", c) != nullptr; };
  std::string lower;
  for (const unsigned char c : value) lower += static_cast<char>(std::tolower(c));
  static const std::set<std::string> WORDS = {"null", "true", "false", "yes", "no", "on", "off", "y", "n"};
  const bool begins = !value.empty() && std::isalnum(static_cast<unsigned char>(value[0])) != 0;
  if (begins && std::all_of(value.begin(), value.end(), plain) && WORDS.count(lower) == 0) return value;
  std::string quoted = "\"";
  for (const char c : value) {
    char code[8] = {c, '\0'};
    if (c == '"' || c == '\\') std::snprintf(code, sizeof code, "\\%c", c);
    if (static_cast<unsigned char>(c) < ' ') std::snprintf(code, sizeof code, "\\x%02x", static_cast<unsigned>(c));
    quoted += code;
  }
  return quoted + "\"";
}

bool isTop(const std::string& line) { return !line.empty() && line[0] != ' ' && line[0] != '#'; }

}  // namespace

std::string withValue(const std::string& text, const std::string& section, const std::string& key,
                      const std::string& value) {
  std::istringstream lines(text);
  std::string changed, line, top;
  while (std::getline(lines, line)) {
    if (isTop(line)) top = keyOf(line);
    const std::size_t at = line.find_first_not_of(' ');
    const bool here = top == section && at != std::string::npos && line.compare(at, key.size() + 1, key + ":") == 0;
    changed += (here ? line.substr(0, at) + key + ": " + written(value) : line) + "\n";
  }
  return changed;
}

std::string withoutKeys(const std::string& text, const std::vector<std::string>& keys) {
  std::istringstream lines(text);
  std::string kept, line;
  bool inside = false;
  while (std::getline(lines, line)) {
    if (isTop(line)) inside = std::find(keys.begin(), keys.end(), keyOf(line)) != keys.end();
    if (!inside) kept += line + "\n";
  }
  return kept;
}

}  // namespace snapwing::vehicle
