#pragma once
/// JSON as text that every reader accepts. Names of files and scenes are bytes, JSON is UTF-8: bytes that are not valid
/// UTF-8 are written as \xHH.

#include <string>

namespace snapwing::common {

/// The text with every byte that is not part of well-formed UTF-8 replaced by \xHH.
std::string shownBytes(const std::string& text);

/// Applies shownBytes to all strings and keys. @tparam Json  nlohmann::json or ordered_json
template <class Json>
void showBytes(Json& json) {
  if (json.is_string()) {
    json = shownBytes(json.template get<std::string>());
  } else if (json.is_object()) {
    Json shown = Json::object();
    for (auto& [key, value] : json.items()) {
      showBytes(value);
      shown[shownBytes(key)] = std::move(value);
    }
    json = std::move(shown);
  } else if (json.is_array()) {
    for (auto& value : json) showBytes(value);
  }
}

/// Indented text with a final newline. NaN becomes null.
template <class Json>
std::string jsonText(Json json) {
  showBytes(json);
  return json.dump(2) + "\n";
}

}  // namespace snapwing::common
