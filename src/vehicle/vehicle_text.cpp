#include "snapwing/vehicle/vehicle_text.h"

#include <algorithm>
#include <sstream>

namespace snapwing::vehicle {

namespace {

std::string keyOf(const std::string& line) { return line.substr(0, line.find(':')); }

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
    changed += (here ? line.substr(0, at) + key + ": " + value : line) + "\n";
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
