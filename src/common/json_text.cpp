#include "snapwing/common/json_text.h"

#include <cstdio>

namespace snapwing::common {

namespace {

/// Bytes of the well-formed UTF-8 character that begins at `at`; 0: none (RFC 3629, table of section 4).
std::size_t characterAt(const std::string& text, std::size_t at) {
  const auto byte = [&](std::size_t k) { return at + k < text.size() ? static_cast<unsigned char>(text[at + k]) : 0u; };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t count = first >= 0xC2 && first < 0xE0   ? 2
                            : first >= 0xE0 && first < 0xF0 ? 3
                            : first >= 0xF0 && first < 0xF5 ? 4
                                                            : 0;
  if (count == 0) return 0;
  const unsigned low = first == 0xE0 ? 0xA0 : first == 0xF0 ? 0x90 : 0x80;
  const unsigned high = first == 0xED ? 0x9F : first == 0xF4 ? 0x8F : 0xBF;
  if (byte(1) < low || byte(1) > high) return 0;
  for (std::size_t k = 2; k < count; ++k) {
    if (byte(k) < 0x80 || byte(k) > 0xBF) return 0;
  }
  return count;
}

}  // namespace

std::string shownBytes(const std::string& text) {
  std::string shown;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t count = characterAt(text, at);
    if (count == 0) {
      char hex[8];
      std::snprintf(hex, sizeof hex, "\\x%02X", static_cast<unsigned char>(text[at++]));
      shown += hex;
    } else {
      shown += text.substr(at, count);
      at += count;
    }
  }
  return shown;
}

}  // namespace snapwing::common
