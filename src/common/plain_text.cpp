#include "snapwing/common/plain_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <sstream>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"

namespace snapwing::common {

namespace {

bool isDigit(char c) { return c >= '0' && c <= '9'; }

std::size_t skipDigits(std::string_view text, std::size_t at) {
  while (at < text.size() && isDigit(text[at])) ++at;
  return at;
}

std::size_t skipSign(std::string_view text, std::size_t at) {
  return at < text.size() && (text[at] == '+' || text[at] == '-') ? at + 1 : at;
}

bool isDecimal(std::string_view text) {
  const std::size_t whole = skipSign(text, 0);
  std::size_t at = skipDigits(text, whole), digits = at - whole;
  if (at < text.size() && text[at] == '.') {
    const std::size_t end = skipDigits(text, at + 1);
    digits += end - at - 1;
    at = end;
  }
  if (digits == 0) return false;
  if (at < text.size() && (text[at] == 'e' || text[at] == 'E')) {
    const std::size_t exponent = skipSign(text, at + 1), end = skipDigits(text, exponent);
    if (end == exponent) return false;
    at = end;
  }
  return at == text.size();
}

/// Of a decimal number that is out of a double's range: whether it is too large, and not too small.
bool isLarge(std::string_view text) {
  const std::size_t exponent = text.find_first_of("eE");
  const std::string_view digits = text.substr(0, exponent);
  const std::size_t point = std::min(digits.find('.'), digits.size());
  const std::size_t first = digits.find_first_of("123456789");
  if (first == std::string_view::npos) return false;
  double power = static_cast<double>(point) - static_cast<double>(first);  // of ten, of the first digit that is not 0
  if (exponent != std::string_view::npos) {
    const std::size_t at = skipSign(text, exponent + 1);
    double shift = 0;
    for (std::size_t k = at; k < text.size(); ++k) shift = 10 * shift + (text[k] - '0');
    power += text[exponent + 1] == '-' ? -shift : shift;
  }
  return power > 0;
}

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

std::vector<std::string> splitFields(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  for (std::string& field : fields) field = trimmed(field);
  return fields;
}

}  // namespace

bool parseNumber(std::string_view text, double* value) {
  if (!isDecimal(text)) return false;
  if (text[0] == '+') text.remove_prefix(1);
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error == std::errc::result_out_of_range) {
    if (isLarge(text)) return false;
    number = 0;
  } else if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(number)) {
    return false;
  }
  *value = number;
  return true;
}

bool parseInteger(std::string_view text, int* value) {
  const std::size_t digits = skipSign(text, 0);
  if (digits == text.size() || skipDigits(text, digits) != text.size()) return false;
  if (text[0] == '+') text.remove_prefix(1);
  return std::from_chars(text.data(), text.data() + text.size(), *value).ec == std::errc();
}

bool hasLeadingZero(std::string_view text) {
  const std::size_t at = skipSign(text, 0);
  return at + 1 < text.size() && text[at] == '0' && isDigit(text[at + 1]);
}

std::string toText(double value) {
  if (std::isnan(value)) return "nan";
  std::array<char, 32> text{};
  for (int digits = 6;; ++digits) {
    char* const begin = text.data();
    char* const end = std::to_chars(begin, begin + text.size(), value, std::chars_format::general, digits).ptr;
    double back = 0;
    std::from_chars(begin, end, back);
    if (back == value || digits >= std::numeric_limits<double>::max_digits10) return std::string(begin, end);
  }
}

std::string plainText(const std::string& bytes, const std::string& path) {
  const auto begins = [&](const char* mark, std::size_t size) { return bytes.compare(0, size, mark, size) == 0; };
  if (begins("\xff\xfe", 2) || begins("\xfe\xff", 2))
    throw FileError(path, "is text in UTF-16 or UTF-32; allowed: UTF-8 (save it again with that encoding)");
  if (bytes.find('\0') != std::string::npos)
    throw FileError(path, "contains zero bytes and is not UTF-8 text (another kind of file, or another encoding)");
  std::string text;
  text.reserve(bytes.size());
  for (std::size_t k = begins("\xef\xbb\xbf", 3) ? 3 : 0; k < bytes.size(); ++k) {
    if (bytes[k] != '\r') {
      text += bytes[k];
    } else if (k + 1 == bytes.size() || bytes[k + 1] != '\n') {
      text += '\n';
    }
  }
  return text;
}

std::string readTextFile(const std::string& path) { return plainText(readFile(path), path); }

std::vector<TextRow> readCsv(const std::string& path) {
  std::istringstream text(readTextFile(path));
  std::vector<TextRow> rows;
  int number = 0;
  for (std::string line; std::getline(text, line);) {
    ++number;
    const std::string content = trimmed(line);
    if (!content.empty() && content[0] != '#') rows.push_back({number, content, splitFields(content)});
  }
  return rows;
}

}  // namespace snapwing::common
