#pragma once
/// JSON as text that every reader takes. Names of files and scenes are bytes, JSON is UTF-8: bytes that are none are
/// shown as \xHH.

#include <string>

namespace snapwing::common {

/// The text with every byte that is no part of well-formed UTF-8 written as \xHH.
std::string shownBytes(const std::string& text);

/// @tparam Json  nlohmann::json or ordered_json
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

/// Indented, ending with a line's end. NaN becomes null.
template <class Json>
std::string jsonText(Json json) {
  showBytes(json);
  return json.dump(2) + "\n";
}

}  // namespace snapwing::common
